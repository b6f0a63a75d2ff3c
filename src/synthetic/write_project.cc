#include "synthetic/write_project.h"

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string_view>

#include "core/atomic_file.h"
#include "core/check.h"
#include "core/parallel.h"
#include "io/mesh_io.h"
#include "light/light_io.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json ToJson(const Eigen::Vector3d& x) { return {x.x(), x.y(), x.z()}; }

void WriteBytes(const fs::path& path, const std::vector<unsigned char>& bytes) {
  WriteFileAtomically(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void WriteGray(const fs::path& path, const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  GLINT_CHECK(cv::imencode(".png", image, bytes));
  WriteBytes(path, bytes);
}

// Writes all that belongs to one view; returns its highlights.
std::vector<TrueHighlight> WriteView(const SyntheticScene& scene, size_t view, const fs::path& dir) {
  cv::Mat image;
  ViewTruth truth;
  RenderView(scene, view, image, truth);
  const std::string& name = scene.model.images[view].name;
  WriteBytes(dir / "images" / name, EncodeImage(scene, image));
  cv::Mat mask(truth.height, truth.width, CV_8UC1, truth.object_mask.data());
  WriteGray(dir / "truth" / "masks" / (name + ".png"), mask);
  if (scene.options.write_masks) WriteGray(dir / "masks" / (name + ".png"), mask);
  const cv::Mat specular(truth.height, truth.width, CV_32FC1, truth.specular.data());
  const cv::Mat bright = specular > 0.5;
  WriteGray(dir / "truth" / "highlights" / (name + ".png"), bright);
  return truth.highlights;
}

void WriteHighlights(const SyntheticScene& scene, const std::vector<std::vector<TrueHighlight>>& highlights,
                     const fs::path& path) {
  Json list = Json::array();
  for (size_t v = 0; v < highlights.size(); ++v)
    for (const TrueHighlight& h : highlights[v])
      list.push_back({{"image", scene.model.images[v].name},
                      {"x", h.px.x()},
                      {"y", h.px.y()},
                      {"light", h.light},
                      {"position", ToJson(h.position)},
                      {"normal", ToJson(h.normal)},
                      {"lit", h.lit},
                      {"strength", h.strength}});
  WriteFileAtomically(path, Json{{"highlights", list}}.dump(1) + "\n");
}

void WritePointOrigins(const SyntheticScene& scene, const fs::path& path) {
  Json file = {{"virtual", Json::array()}, {"object", Json::array()}, {"surroundings", Json::array()}};
  for (size_t i = 0; i < scene.model.points.size(); ++i) {
    const SyntheticPoint::Origin origin = scene.point_origins[i];
    const char* kind = origin == SyntheticPoint::Origin::kHighlight ? "virtual"
                       : origin == SyntheticPoint::Origin::kMark    ? "object"
                                                                    : "surroundings";
    file[kind].push_back(scene.model.points[i].id);
  }
  WriteFileAtomically(path, file.dump() + "\n");
}

}  // namespace

void WriteSyntheticProject(const SyntheticScene& scene, const fs::path& dir, Progress& progress) {
  const size_t count = scene.model.images.size();
  WriteModel(scene.model, dir / "sparse" / "0");
  WriteMesh(dir / "truth" / "mesh.ply", TrueMesh(scene));
  WriteLights(dir / "truth" / "lights.json", scene.lights);
  WritePointOrigins(scene, dir / "truth" / "points.json");
  std::vector<std::vector<TrueHighlight>> highlights(count);
  progress.Begin("views", count);
  ParallelFor(count, 1, [&](size_t v) {
    progress.ThrowIfCancelled();
    highlights[v] = WriteView(scene, v, dir);
    progress.Advance();
  });
  WriteHighlights(scene, highlights, dir / "truth" / "highlights.json");
}

}  // namespace glint
