#include "pipeline/seed_stage.h"

#include <fmt/format.h>

#include <algorithm>

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

SeedStageResult FromPoints(const Scene& scene, const ImageSource& images, const SeedOptions& options,
                           Progress& progress) {
  SeedSummary summary;
  SeedResult seed = BuildSeed(scene, options, &summary, progress, &images);
  SeedStageResult result;
  result.mesh = std::move(seed.mesh);
  result.start = std::move(seed.smooth);
  result.point_used = std::move(seed.point_used);
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
