#include "pipeline/seed_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "pipeline/given_mesh.h"
#include "seed/build_seed.h"

namespace glint {
namespace {

SeedStageResult FromGivenMesh(const Scene& scene, const std::filesystem::path& path, const GivenMeshOptions& options) {
  GivenMesh given = ReadGivenMesh(path, scene, options);
  SeedStageResult result;
  const auto used = given.point_used.size() - std::count(given.point_used.begin(), given.point_used.end(), 0);
  result.report = fmt::format("{}: {} faces, {} of {} points lie near it", path.string(), given.mesh.faces.size(), used,
                              scene.points.size());
  result.mesh = std::move(given.mesh);
  result.start = result.mesh;
  result.point_used = std::move(given.point_used);
  result.notes = std::move(given.notes);
  return result;
}

// Green: on the seed, light green: the object's too, brown: ground, grey: something else, yellow: unreliable, red:
// virtual.
TriangleMesh ColoredPoints(const Scene& scene, const std::vector<PointFate>& fate) {
  constexpr std::array<std::array<uint8_t, 3>, 6> kColors = {
      {{0, 140, 0}, {140, 220, 140}, {150, 100, 50}, {150, 150, 150}, {240, 200, 0}, {230, 0, 0}}};
  TriangleMesh cloud;
  for (size_t i = 0; i < fate.size(); ++i) {
    cloud.vertices.push_back(scene.points[i].position);
    cloud.colors.push_back(kColors[static_cast<size_t>(fate[i])]);
  }
  return cloud;
}

// How to choose otherwise than was done.
std::string ChoiceNote(const Scene& scene, const std::vector<PointFate>& fate) {
  Eigen::AlignedBox3d box;
  for (size_t i = 0; i < fate.size(); ++i)
    if (fate[i] == PointFate::kUsed || fate[i] == PointFate::kObject) box.extend(scene.points[i].position);
  if (box.isEmpty()) return "";
  const Eigen::Vector3d c = box.center(), s = box.sizes();
  return fmt::format(
      "the object was taken from the points in the box {:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g} (centre and size); "
      "stages/points.ply shows them in green; to choose otherwise give another box with --set seed.object.box=... or "
      "masks",
      c.x(), c.y(), c.z(), s.x(), s.y(), s.z());
}

SeedStageResult FromPoints(const Scene& scene, const ImageSource& images, const SeedOptions& options,
                           Progress& progress) {
  SeedSummary summary;
  SeedResult seed = BuildSeed(scene, options, &summary, progress, &images);
  SeedStageResult result;
  result.mesh = std::move(seed.mesh);
  result.start = std::move(seed.smooth);
  result.point_used = std::move(seed.point_used);
  result.outline = std::move(seed.outline);
  result.points = ColoredPoints(scene, seed.fate);
  if (const std::string note = ChoiceNote(scene, seed.fate); !note.empty()) result.notes.push_back(note);
  result.report = summary.BriefReport();
  result.warnings = std::move(summary.warnings);
  return result;
}

}  // namespace

SeedStageResult RunSeedStage(const Scene& scene, const ImageSource& images, const std::filesystem::path& given_mesh,
                             const Config& config, Progress& progress) {
  return given_mesh.empty() ? FromPoints(scene, images, config.seed, progress)
                            : FromGivenMesh(scene, given_mesh, config.given_mesh);
}

}  // namespace glint
