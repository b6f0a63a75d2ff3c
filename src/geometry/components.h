// The connected parts of a mesh, and how they lie in each other.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/edge_topology.h"
#include "geometry/triangle_mesh.h"

namespace glint {

struct Component {
  uint32_t first_face = 0;    // the lowest
  uint32_t largest_face = 0;  // by area
  size_t num_faces = 0;
  bool closed = true;  // no boundary edge
  double volume = 0;   // by the divergence theorem about the mesh's centre; meaningful if closed
  // Winding number of the whole mesh right before and right behind the largest face, rounded. In a mesh that bounds a
  // solid they are 0 and 1 for every component, cavities included; −1 and 0 for a component that is inside out;
  // anything else where solids lie in each other or overlap.
  int winding_front = 0, winding_back = 0;

  bool bounds_solid() const { return winding_front == 0 && winding_back == 1; }
  bool inside_out() const { return winding_front == -1 && winding_back == 0; }
};

struct Components {
  std::vector<uint32_t> of_face;
  std::vector<Component> list;  // by lowest face
};

// Faces that share an edge belong together.
Components FindComponents(const TriangleMesh& mesh, const EdgeTopology& topology);

// Fills in the windings. Needs all components closed.
void FindWindings(const TriangleMesh& mesh, Components& components);

// The number of fans of faces around all vertices: the vertices the mesh would have if fans that only touch in a vertex
// were apart. If `split` is given it receives the vertices with more than one fan, ascending.
size_t CountFans(const TriangleMesh& mesh, const EdgeTopology& topology, std::vector<uint32_t>* split = nullptr);

}  // namespace glint
