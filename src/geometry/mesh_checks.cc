#include "geometry/mesh_checks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/clean_mesh.h"
#include "geometry/components.h"
#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"
#include "geometry/self_intersections.h"

namespace glint {

namespace {

// Collects one kind of fault, and reports it if there was any.
class Fault {
 public:
  Fault(MeshChecks& checks, const MeshCheckOptions& options, std::string kind)
      : checks_(checks), max_places_(options.max_places) {
    fault_.kind = std::move(kind);
  }
  ~Fault() {
    if (fault_.count > 0) checks_.faults.push_back(std::move(fault_));
  }
  Fault(const Fault&) = delete;
  Fault& operator=(const Fault&) = delete;
  void Add(const Eigen::Vector3d& place) {
    ++fault_.count;
    if (fault_.places.size() < max_places_) fault_.places.push_back(place);
  }

 private:
  MeshChecks& checks_;
  size_t max_places_;
  MeshFault fault_;
};

Eigen::Vector3d Center(const TriangleMesh& mesh, size_t f) {
  const Eigen::Vector3i& v = mesh.faces[f];
  return (mesh.vertices[v[0]] + mesh.vertices[v[1]] + mesh.vertices[v[2]]) / 3;
}

// The faces whose indices and coordinates can be used.
TriangleMesh UsableFaces(const TriangleMesh& mesh, const MeshCheckOptions& options, MeshChecks& checks) {
  Fault bad_index(checks, options, "faces with vertex indices out of range");
  Fault bad_vertex(checks, options, "faces with coordinates that are not finite");
  TriangleMesh out;
  out.vertices = mesh.vertices;
  std::vector<bool> used(mesh.vertices.size(), false);
  const int num_vertices = static_cast<int>(mesh.vertices.size());
  for (const Eigen::Vector3i& face : mesh.faces) {
    if (face.minCoeff() < 0 || face.maxCoeff() >= num_vertices) {
      bad_index.Add(Eigen::Vector3d::Constant(std::nan("")));
      continue;
    }
    bool finite = true;
    for (int k = 0; k < 3; ++k) {
      used[face[k]] = true;
      finite = finite && mesh.vertices[face[k]].allFinite() && mesh.vertices[face[k]].cwiseAbs().maxCoeff() < 1e100;
    }
    if (finite) {
      out.faces.push_back(face);
    } else {
      bad_vertex.Add(mesh.vertices[face[0]]);
    }
  }
  checks.unused_vertices = static_cast<size_t>(std::count(used.begin(), used.end(), false));
  return out;
}

void CheckFaces(const TriangleMesh& mesh, const CleanMesh& clean, const MeshCheckOptions& options, MeshChecks& checks) {
  Fault no_area(checks, options, "faces without area");
  size_t next = 0;  // faces of `mesh` that are missing in `clean` have two corners in one place
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    const bool kept = next < clean.source_face.size() && clean.source_face[next] == f;
    next += kept;
    const Eigen::Vector3i& v = mesh.faces[f];
    if (!kept || AccurateNormal(mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]).isZero(0))
      no_area.Add(Center(mesh, f));
  }
  Fault duplicate(checks, options, "duplicate faces");
  std::vector<std::array<int, 4>> sorted(clean.mesh.faces.size());
  for (size_t f = 0; f < sorted.size(); ++f) {
    const Eigen::Vector3i& v = clean.mesh.faces[f];
    sorted[f] = {v[0], v[1], v[2], static_cast<int>(f)};
    std::sort(sorted[f].begin(), sorted[f].begin() + 3);
  }
  std::sort(sorted.begin(), sorted.end());
  for (size_t i = 1; i < sorted.size(); ++i)
    if (std::equal(sorted[i].begin(), sorted[i].begin() + 3, sorted[i - 1].begin()))
      duplicate.Add(Center(clean.mesh, sorted[i][3]));
}

void CheckEdges(const TriangleMesh& mesh, const EdgeTopology& topology, const MeshCheckOptions& options,
                MeshChecks& checks) {
  Fault boundary(checks, options, "boundary edges"), non_manifold(checks, options, "non-manifold edges");
  Fault misoriented(checks, options, "edges whose two faces disagree in orientation");
  for (size_t e = 0; e < topology.num_edges(); ++e) {
    const auto corners = topology.CornersOf(e);
    const auto start = [&](uint32_t c) { return mesh.faces[c / 3][c % 3]; };
    const auto end = [&](uint32_t c) { return mesh.faces[c / 3][(c % 3 + 1) % 3]; };
    const Eigen::Vector3d middle = (mesh.vertices[start(corners[0])] + mesh.vertices[end(corners[0])]) / 2;
    if (corners.size() == 1) boundary.Add(middle);
    if (corners.size() > 2) non_manifold.Add(middle);
    if (corners.size() == 2 && start(corners[0]) == start(corners[1])) misoriented.Add(middle);
  }
}

void CheckTopology(const TriangleMesh& mesh, const MeshCheckOptions& options, MeshChecks& checks) {
  const EdgeTopology topology = BuildEdgeTopology(mesh);
  CheckEdges(mesh, topology, options, checks);
  const EdgeCounts counts = CountEdges(mesh, topology);
  checks.closed = counts.boundary == 0 && !mesh.faces.empty();
  checks.oriented = counts.misoriented == 0 && counts.non_manifold == 0;
  std::vector<uint32_t> split;
  const long fans = static_cast<long>(CountFans(mesh, topology, &split));
  {
    Fault touching(checks, options, "vertices where separate parts touch");
    for (uint32_t v : split) touching.Add(mesh.vertices[v]);
  }
  checks.manifold = counts.non_manifold == 0 && split.empty();
  Components components = FindComponents(mesh, topology);
  checks.num_components = components.list.size();
  for (const Component& c : components.list) checks.num_closed_components += c.closed;
  if (!checks.closed || !checks.oriented) return;
  const long euler = fans - static_cast<long>(topology.num_edges()) + static_cast<long>(mesh.faces.size());
  if (checks.manifold) checks.genus = (2 * static_cast<long>(components.list.size()) - euler) / 2;
  checks.inside_out = checks.volume < 0;
  FindWindings(mesh, components);
  Fault turned(checks, options, "components that are inside out"), nested(checks, options, "components inside others");
  for (const Component& c : components.list) {
    if (c.inside_out()) turned.Add(Center(mesh, c.largest_face));
    if (!c.inside_out() && !c.bounds_solid()) nested.Add(Center(mesh, c.largest_face));
    checks.num_cavities += c.bounds_solid() && c.volume < 0;
  }
}

}  // namespace

MeshChecks CheckMeshSoundness(const TriangleMesh& mesh, const MeshCheckOptions& options) {
  MeshChecks checks;
  checks.num_vertices = mesh.vertices.size();
  checks.num_faces = mesh.faces.size();
  const TriangleMesh usable = UsableFaces(mesh, options, checks);
  if (usable.faces.empty()) return checks;
  const CleanMesh clean = Clean(usable);
  checks.welded_vertices = clean.welded_vertices;
  checks.area = SurfaceArea(clean.mesh);
  checks.volume = SignedVolume(clean.mesh);
  CheckFaces(usable, clean, options, checks);
  CheckTopology(clean.mesh, options, checks);
  if (options.self_intersections) {
    Fault crossing(checks, options, "pairs of faces that pass through each other");
    for (const auto& [f, g] : SelfIntersections(clean.mesh))
      crossing.Add((Center(clean.mesh, f) + Center(clean.mesh, g)) / 2);
  }
  return checks;
}

}  // namespace glint
