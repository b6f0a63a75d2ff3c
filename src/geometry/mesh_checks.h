// What is wrong with a mesh, with counts and places.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint {

// One kind of fault: how often, and where the first few of them are.
struct MeshFault {
  std::string kind;  // in words, plural: "boundary edges"
  size_t count = 0;
  std::vector<Eigen::Vector3d> places;
};

struct MeshChecks {
  size_t num_vertices = 0, num_faces = 0;  // as given
  size_t welded_vertices = 0;              // exact duplicates of another vertex; no fault by itself
  size_t unused_vertices = 0;
  size_t num_components = 0;  // of faces connected by edges, after welding
  size_t num_closed_components = 0;
  size_t num_cavities = 0;        // closed, oriented inward, inside another component
  bool closed = false;            // no boundary edge
  bool oriented = false;          // every pair of neighbours agrees
  bool inside_out = false;        // closed and oriented, but its volume is negative
  bool manifold = false;          // no edge of three faces or more, no vertex where separate fans touch
  long genus = -1;                // the sum over the components; -1 unless closed, oriented and manifold
  double area = 0, volume = 0;    // volume by the divergence theorem, meaningless unless closed
  std::vector<MeshFault> faults;  // only those that occur

  // The pseudo-normal's sign is exact: closed, oriented outward, without self-intersections and degenerate faces.
  bool sound() const { return faults.empty(); }
  // It has an inside; it may pass through itself.
  bool bounds_a_solid() const { return closed && oriented && manifold && !inside_out; }
};

struct MeshCheckOptions {
  bool self_intersections = true;  // the one check that is not of linear time
  size_t max_places = 5;           // of each fault
};

// Never throws on account of the mesh: bad indices and coordinates are faults too, and the faces that have them are
// left out of the other checks.
MeshChecks CheckMeshSoundness(const TriangleMesh& mesh, const MeshCheckOptions& options = {});

}  // namespace glint
