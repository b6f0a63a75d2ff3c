#include "pipeline/given_mesh.h"

#include <fmt/format.h>

#include <array>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/closest_point.h"
#include "geometry/edge_topology.h"
#include "geometry/mesh_checks.h"
#include "io/mesh_io.h"
#include "sdf/extract_mesh.h"
#include "sdf/mesh_to_level_set.h"

namespace glint {
namespace {

constexpr std::array<double, 3> kHalfWidths = {3, 12, 60};

bool AnyViewSees(const TriangleMesh& mesh, const Scene& scene) {
  for (const View& view : scene.views)
    for (const Eigen::Vector3d& x : mesh.vertices)
      if (const auto px = view.Project(x); px && view.Contains(*px)) return true;
  return false;
}

TriangleMesh MadeSound(const std::filesystem::path& path, const TriangleMesh& mesh, const GivenMeshOptions& options,
                       std::vector<std::string>& notes) {
  const MeshChecks checks = CheckMeshSoundness(mesh, {.self_intersections = false, .max_places = 0});
  if (checks.bounds_a_solid()) return mesh;
  TriangleMesh sound;
  const double voxel = options.closing_voxel_rel * Diagonal(WithoutUnusedVertices(mesh));
  // What closes an opening lies half as far from the mesh as that is wide: the band must reach there.
  for (const double half_width_voxels : kHalfWidths) {
    sound = ExtractMesh(MeshToLevelSet(mesh, voxel, {.half_width_voxels = half_width_voxels}));
    if (EdgesBalanced(sound)) break;
  }
  if (sound.empty() || !EdgesBalanced(sound))
    throw InputError(path.string(), "", "the mesh encloses nothing; expected the surface of a solid object");
  std::string faults;
  for (const MeshFault& fault : checks.faults)
    faults += fmt::format("{}{} {}", faults.empty() ? "" : ", ", fault.count, fault.kind);
  notes.push_back(fmt::format("{}: made closed and oriented by way of a signed distance field ({})", path.string(),
                              faults.empty() ? "it was inside out" : faults));
  return sound;
}

}  // namespace

void GivenMeshOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "point_distance_rel",
           .help = "Sparse points at most this far from the given mesh count as the object's.",
           .unit = "fraction of the diagonal",
           .min = 0,
           .max = 1},
          point_distance_rel);
  v.Field({.name = "closing_voxel_rel",
           .help = "Voxel size of the field through which a mesh that is open or not manifold is closed.",
           .unit = "fraction of the diagonal",
           .min = 0.0005,
           .max = 0.1},
          closing_voxel_rel);
}

GivenMesh ReadGivenMesh(const std::filesystem::path& path, const Scene& scene, const GivenMeshOptions& options) {
  const TriangleMesh raw = ReadMesh(path);
  if (!AnyViewSees(raw, scene))
    throw InputError(path.string(), "", "no camera of the project sees this mesh; expected a mesh in COLMAP's frame");
  GivenMesh given;
  given.mesh = MadeSound(path, raw, options, given.notes);
  const ClosestPointQuery query(given.mesh);
  const double reach = options.point_distance_rel * Diagonal(given.mesh);
  given.point_used.resize(scene.points.size());
  ParallelFor(scene.points.size(), 256,
              [&](size_t i) { given.point_used[i] = query.Find(scene.points[i].position, reach).has_value(); });
  return given;
}

}  // namespace glint
