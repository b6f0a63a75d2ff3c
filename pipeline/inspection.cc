#include "pipeline/inspection.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <opencv2/core/mat.hpp>
#include <set>

#include "colmap/project.h"
#include "colmap/scene.h"
#include "core/error.h"
#include "core/median.h"
#include "geometry/mesh_checks.h"
#include "io/mesh_io.h"
#include "io/project_images.h"
#include "io/vdb_io.h"

namespace glint {
namespace {

std::string Vector(const Eigen::Vector3d& x) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", x[0], x[1], x[2]); }

const char* YesNo(bool value) { return value ? "yes" : "no"; }

// What stands in the way of using it, and what is merely worth knowing.
struct Verdict {
  std::vector<std::string> problems, hints;

  Inspection Conclude(std::string text, const std::string& use) const {
    for (const std::string& problem : problems) text += fmt::format("problem      {}\n", problem);
    for (const std::string& hint : hints) text += fmt::format("note         {}\n", hint);
    text += problems.empty() ? fmt::format("fit for {}\n", use) : fmt::format("not fit for {} as it is\n", use);
    return {std::move(text), problems.empty()};
  }
};

std::string DescribeCameras(const Scene& scene) {
  std::set<std::string> kinds;
  for (const View& view : scene.views)
    kinds.insert(fmt::format("{} {}x{}", CameraModelName(static_cast<int>(view.camera.model)).value_or("unknown model"),
                             view.camera.width, view.camera.height));
  return fmt::format("{}", fmt::join(kinds, ", "));
}

std::string DescribePoints(const Scene& scene) {
  std::vector<double> errors, lengths;
  for (const ScenePoint& point : scene.points) {
    if (point.error_px >= 0) errors.push_back(point.error_px);
    lengths.push_back(static_cast<double>(point.observations.size()));
  }
  return fmt::format("{}, median error {:.2f} px, median track {} images", scene.points.size(), Median(errors),
                     Median(lengths));
}

// Decodes every image that is there; what cannot be used becomes a problem.
void ReadEveryImage(const ProjectImages& images, Verdict& verdict, Progress& progress) {
  progress.Begin("read images", images.size());
  for (size_t v = 0; v < images.size(); ++v) {
    progress.ThrowIfCancelled();
    try {
      cv::Mat image;
      images.Load(v, image);
    } catch (const InputError& e) {
      verdict.problems.push_back(e.what());
    }
    progress.Advance();
  }
}

Inspection InspectProject(const InspectArguments& arguments, Progress& progress) {
  const ProjectPaths paths = FindProject(arguments.path, arguments.images, arguments.masks);
  const Model model = ReadModel(paths.model);
  const Scene scene = MakeScene(model);
  Verdict verdict;
  verdict.hints = paths.notes;
  verdict.hints.insert(verdict.hints.end(), model.warnings.begin(), model.warnings.end());
  std::string text =
      fmt::format("COLMAP project {}\nmodel        {}\nimages       {}\nmasks        {}\n", arguments.path.string(),
                  paths.model.string(), paths.images.empty() ? "not found" : paths.images.string(),
                  paths.masks.empty() ? "none" : paths.masks.string());
  text += fmt::format("views        {}\ncameras      {}: {}\npoints       {}\n", scene.views.size(),
                      model.cameras.size(), DescribeCameras(scene), DescribePoints(scene));
  if (scene.views.size() < 3)
    verdict.problems.push_back(fmt::format("{} views; at least 3 are needed", scene.views.size()));
  if (scene.points.empty()) verdict.problems.push_back("no points: give a mesh with --mesh");
  if (paths.images.empty()) {
    verdict.problems.push_back("no folder of images beside the model: give it with --images");
  } else {
    try {
      const ProjectImages images(scene, paths, progress);
      text += fmt::format("image files  {} of {} found\n", images.size() - images.missing().size(), images.size());
      if (!images.missing().empty())
        verdict.hints.push_back(
            fmt::format("missing: {}{}", images.missing().front(), images.missing().size() > 1 ? ", ..." : ""));
      if (arguments.read_images) ReadEveryImage(images, verdict, progress);
    } catch (const InputError& e) {
      verdict.problems.push_back(e.what());
    }
  }
  verdict.hints.push_back("the lights are found from the highlights, unless they are given with --lights FILE");
  return verdict.Conclude(text, "glint run");
}

Inspection InspectMesh(const std::filesystem::path& path) {
  const TriangleMesh mesh = ReadMesh(path);
  const MeshChecks checks = CheckMeshSoundness(mesh);
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  std::string text = fmt::format("mesh {}\nvertices     {}{}\nfaces        {}\n", path.string(), checks.num_vertices,
                                 mesh.normals.empty() ? "" : ", with normals", checks.num_faces);
  text += fmt::format("box          {} to {}, diagonal {:.6g}\n", Vector(box.min()), Vector(box.max()), Diagonal(mesh));
  text += fmt::format("components   {}, {} of them closed, {} cavities\n", checks.num_components,
                      checks.num_closed_components, checks.num_cavities);
  text += fmt::format("closed       {}\nmanifold     {}\noriented     {}\n", YesNo(checks.closed),
                      YesNo(checks.manifold), checks.inside_out ? "inside out" : YesNo(checks.oriented));
  if (checks.genus >= 0) text += fmt::format("genus        {}\n", checks.genus);
  text += fmt::format("area         {:.6g}\n", checks.area);
  if (checks.closed) text += fmt::format("volume       {:.6g}\n", checks.volume);
  for (const auto& [name, values] : mesh.scalars) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    if (low != values.end()) text += fmt::format("attribute    {}: {:g} to {:g}\n", name, *low, *high);
  }
  Verdict verdict;
  for (const MeshFault& fault : checks.faults) {
    std::string places;
    for (const Eigen::Vector3d& place : fault.places) places += fmt::format(" {}", Vector(place));
    verdict.hints.push_back(
        fmt::format("{} {}, at{}{}", fault.count, fault.kind, places, fault.count > fault.places.size() ? " ..." : ""));
  }
  if (!checks.sound())
    verdict.hints.push_back("glint sdf signs such a mesh by winding number; glint run --mesh closes it");
  return verdict.Conclude(text, "glint sdf and glint run --mesh");
}

Inspection InspectVdb(const std::filesystem::path& path) {
  Verdict verdict;
  const LevelSet field = ReadVdb(path, &verdict.hints);
  const Eigen::AlignedBox3d box = field.ActiveBox();
  const std::string text = fmt::format(
      "signed distance field {}\nvoxel size   {:.6g}\nband         {:g} voxels to either side\nactive       {} voxels\n"
      "memory       {:.1f} MB\nbox          {} to {}\n",
      path.string(), field.voxel_size(), field.half_width_voxels(), field.num_active_voxels(),
      static_cast<double>(field.memory_bytes()) / 1e6, Vector(box.min()), Vector(box.max()));
  return verdict.Conclude(text, "glint mesh");
}

}  // namespace

Inspection Inspect(const InspectArguments& arguments, Progress& progress) {
  if (std::filesystem::is_directory(arguments.path)) return InspectProject(arguments, progress);
  if (arguments.path.extension() == ".vdb") return InspectVdb(arguments.path);
  return InspectMesh(arguments.path);
}

}  // namespace glint
