// What a narrow band will take, said before it is taken.
#pragma once

#include <cstddef>

#include "geometry/triangle_mesh.h"

namespace glint {

// Bytes that the narrow band of a mesh will need, about, grid and work space, beyond the mesh itself. Winding numbers
// take more a triangle. voxel_size is 1 for coordinates in voxels.
double PredictBandBytes(const TriangleMesh& mesh, double half_width_voxels, double voxel_size = 1,
                        bool by_winding = false);

// Throws InputError if the coordinates do not fit OpenVDB's 32-bit indices or if the prediction exceeds
// max_memory_gb (0: the memory that is free now). Gives the prediction.
double CheckGridFits(const TriangleMesh& mesh_in_index, double half_width_voxels, double max_memory_gb,
                     bool by_winding = false);

// The same for a dense grid of so many voxels, in the memory that is free now. Gives the bytes that it will need.
double CheckDenseFits(double num_voxels, size_t num_faces);

}  // namespace glint
