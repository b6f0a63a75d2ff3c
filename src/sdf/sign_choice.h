// What "auto" means for a mesh, told from the mesh alone.
#pragma once

#include "sdf/mesh_to_level_set.h"
#include "sdf/prepared_mesh.h"

namespace glint::internal {

// Fills in sign ("pseudonormal" or "winding") and reason.
void ChooseSign(const PreparedMesh& prepared, SdfSummary& summary);

}  // namespace glint::internal
