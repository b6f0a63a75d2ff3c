#include "seed/remesh.h"

#include <CGAL/Polygon_mesh_processing/remesh.h>

#include "core/check.h"
#include "seed/surface_mesh.h"

namespace glint {

TriangleMesh RemeshEvenly(const TriangleMesh& mesh, double edge_length, int iterations) {
  namespace pmp = CGAL::Polygon_mesh_processing;
  GLINT_CHECK_GT(edge_length, 0);
  internal::CgalMesh surface = internal::ToCgal(mesh);
  pmp::isotropic_remeshing(surface.faces(), edge_length, surface, pmp::parameters::number_of_iterations(iterations));
  surface.collect_garbage();
  return internal::FromCgal(surface);
}

}  // namespace glint
