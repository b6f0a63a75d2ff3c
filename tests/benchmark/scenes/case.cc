#include "tests/benchmark/scenes/case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <random>

#include "colmap/project.h"
#include "colmap/scene.h"
#include "core/parallel.h"
#include "io/mesh_io.h"
#include "io/project_images.h"
#include "light/light_io.h"
#include "metrics/swept_region.h"
#include "pipeline/comparison.h"
#include "pipeline/run.h"
#include "pipeline/similarity.h"
#include "pipeline/terminal.h"
#include "synthetic/write_project.h"

namespace glint::benchmark {
namespace {

namespace fs = std::filesystem;

// Maps as a network makes them: right in detail, each turned and bent in its own way.
void WriteNormalMaps(const Scene& scene, const TriangleMesh& truth, double off_deg, uint64_t seed,
                     const fs::path& folder) {
  const RayCaster caster(truth);
  for (size_t v = 0; v < scene.views.size(); ++v) {
    const View& view = scene.views[v];
    std::mt19937_64 random(seed * 1000 + v);
    std::normal_distribution<double> error(0, off_deg * M_PI / 180 / std::sqrt(2.0));
    const Eigen::Vector3d turn(error(random), error(random), error(random));
    const Eigen::Vector3d bend(error(random), error(random), error(random));
    const auto width = static_cast<int>(view.camera.width) / 2, height = static_cast<int>(view.camera.height) / 2;
    cv::Mat map(height, width, CV_8UC3, cv::Scalar::all(0));
    ParallelFor(height, 4, [&](size_t row) {
      const auto y = static_cast<int>(row);
      for (int x = 0; x < width; ++x) {
        const auto ray = view.RayThrough({2 * x + 1.0, 2 * y + 1.0});
        const auto hit = ray ? caster.Intersect(view.Center(), *ray) : std::nullopt;
        if (!hit) continue;
        const double wave = std::sin(6.0 * x / width + 4.0 * y / height + static_cast<double>(v));
        const Eigen::Vector3d n = (InterpolatedNormal(truth, *hit) + turn + wave * bend).normalized();
        const Eigen::Vector3d in_camera = view.cam_from_world.rotation * n;
        const auto code = [](double c) { return static_cast<uchar>(std::lround(127.5 * (1 + c))); };
        map.at<cv::Vec3b>(y, x) = {code(-in_camera.z()), code(-in_camera.y()), code(in_camera.x())};
      }
    });
    WriteImagePng(folder / (view.name + ".png"), map);
  }
}

}  // namespace

Case SyntheticCase(const SyntheticOptions& options, const Plan& plan) {
  Case c;
  c.name = fmt::format("{} {}x{}{}{}", options.scene, options.lights, options.light_kind,
                       options.seed == 1 ? "" : fmt::format(" s{}", options.seed), plan.unknown ? " ?" : "");
  c.num_views = options.views;
  c.num_lights = options.lights;
  c.project = plan.out / fmt::format("{}-{}-{}-{}-{}", options.scene, options.lights, options.light_kind, options.views,
                                     options.seed);
  const fs::path truth = c.project / "truth";
  if (!fs::exists(truth / "mesh.ply")) WriteSyntheticProject(SynthesizeScene(options), c.project);
  c.truth = ReadMesh(truth / "mesh.ply");
  c.out = c.project / (plan.unknown ? "unknown" : "glint");
  if (!plan.unknown) c.lights = truth / "lights.json";
  const Scene scene = MakeScene(ReadModel(FindProject(c.project).model));
  c.regions.swept = SweptRegion(c.truth, scene, ReadLights(truth / "lights.json"));
  const std::vector<uint16_t> views = VisibleViews(c.truth, scene);
  for (size_t v = 0; v < views.size(); ++v) {
    c.regions.rest.push_back(!c.regions.swept[v]);
    c.regions.seen.push_back(!c.regions.swept[v] && views[v] > 0);
  }
  if (plan.normal_maps_deg >= 0) {
    c.normals = c.project / "normals";
    fs::create_directories(c.normals);
    WriteNormalMaps(scene, c.truth, plan.normal_maps_deg, options.seed, c.normals);
  }
  return c;
}

Case VaseCase(const fs::path& vase, const Plan& plan) {
  Case c;
  c.name = plan.unknown ? "vase ?" : "vase";
  c.project = vase / "project";
  c.out = plan.out / (plan.unknown ? "vase-unknown" : "vase");
  if (!plan.unknown) c.lights = vase / "lights.json";
  c.truth = ReadMesh(vase / "truth" / "gt_mesh.ply");
  c.truth_from_project = ReadSimilarity(vase / "truth" / "sim3_colmap_to_gt.json");
  c.regions.swept.resize(c.truth.vertices.size());
  c.regions.rest.resize(c.truth.vertices.size());
  for (const auto& [name, values] : c.truth.scalars)
    for (size_t v = 0; v < values.size(); ++v) {
      if (name == "nhl") c.regions.swept[v] = values[v] > 0;
      if (name == "nviews") c.regions.rest[v] = values[v] > 0;
    }
  for (size_t v = 0; v < c.regions.rest.size(); ++v) c.regions.rest[v] = c.regions.rest[v] && !c.regions.swept[v];
  c.regions.seen = c.regions.rest;
  return c;
}

double RunCase(const Case& c, const Plan& plan, const std::vector<std::string>& settings, const fs::path& out) {
  std::vector<std::string> all = plan.settings;
  all.insert(all.end(), settings.begin(), settings.end());
  Config config = ResolveConfig({}, all);
  config.output.overlays = false;
  Terminal quiet(Verbosity::kQuiet);
  RunArguments arguments;
  arguments.project = c.project;
  arguments.lights = c.lights;
  arguments.normals = c.normals;
  arguments.mesh = c.mesh;
  arguments.out = out;
  if (!plan.from.empty()) {
    const auto from = std::find(kRunStageNames.begin(), kRunStageNames.end(), plan.from);
    arguments.stages.from = static_cast<RunStage>(from - kRunStageNames.begin());
  }
  double seconds = 0;
  for (const StageTime& t : Run(arguments, config, quiet).times) seconds += t.seconds;
  return seconds;
}

Measured MeasureMesh(const Case& c, TriangleMesh mesh) {
  Transform(c.truth_from_project, mesh);
  EnsureNormals(mesh);
  return Measure(mesh, c.truth, c.regions);
}

Measured MeasureFile(const Case& c, const fs::path& mesh) { return MeasureMesh(c, ReadMesh(mesh)); }

}  // namespace glint::benchmark
