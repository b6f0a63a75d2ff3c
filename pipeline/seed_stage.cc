#include "pipeline/seed_stage.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "pipeline/given_mesh.h"

namespace glint {
namespace {

SeedStageResult FromGivenMesh(const Scene& scene, const std::filesystem::path& path, const GivenMeshOptions& options) {
  GivenMesh given = ReadGivenMesh(path, scene, options);
  SeedStageResult result;
  const auto used = given.point_used.size() - std::count(given.point_used.begin(), given.point_used.end(), 0);
  result.report = fmt::format("{}: {} faces, {} of {} points lie near it", path.string(), given.mesh.faces.size(), used,
                              scene.points.size());
  result.mesh = std::move(given.mesh);
  result.point_used = std::move(given.point_used);
  result.notes = std::move(given.notes);
  return result;
}

}  // namespace

SeedStageResult RunSeedStage(const Scene& scene, const ImageSource&, const std::filesystem::path& given_mesh,
                             const Config& config, Progress&) {
  if (given_mesh.empty()) throw NoResultError("no mesh given with --mesh");
  return FromGivenMesh(scene, given_mesh, config.given_mesh);
}

}  // namespace glint
