#include "sdf/sign_choice.h"

#include "geometry/components.h"
#include "geometry/edge_topology.h"
#include "geometry/self_intersections.h"

namespace glint::internal {

void ChooseSign(const PreparedMesh& prepared, SdfSummary& summary) {
  summary.sign = "winding";
  if (!prepared.balanced) {
    summary.reason = "the mesh is not closed and consistently oriented: " + DescribeEdges(prepared.mesh);
    return;
  }
  const EdgeTopology topology = BuildEdgeTopology(prepared.mesh);
  Components components = FindComponents(prepared.mesh, topology);
  FindWindings(prepared.mesh, components);
  for (const Component& c : components.list)
    if (!c.bounds_solid()) {
      summary.reason = "components of the mesh are inside out or inside others";
      return;
    }
  if (!SelfIntersections(prepared.mesh, 1).empty()) {
    summary.reason = "faces of the mesh pass through each other";
    return;
  }
  summary.sign = "pseudonormal";
  summary.reason = "the mesh is closed and consistently oriented, and no faces pass through each other";
}

}  // namespace glint::internal
