// How far a narrow band is from the truth.
#pragma once

#include <cstddef>
#include <string>

#include "sdf/level_set.h"
#include "tests/benchmark/sdf/truth.h"

namespace glint::benchmark {

struct FieldErrors {
  size_t distances = 0;  // voxels whose distance was checked
  double worst_rel = 0;  // largest error, fraction of the diagonal
  double worst_voxels = 0;
  size_t missing = 0;  // inactive though nearer than the half width (checked voxels)
  size_t signs = 0;    // voxels whose sign was checked, active or not
  size_t wrong_signs = 0;
  size_t on_surface = 0;  // so near that rounding of the coordinates decides; left out
};

FieldErrors operator+(const FieldErrors& a, const FieldErrors& b);

// `pairs`: triangles times voxels to spend on brute force. Every voxel of every leaf has its sign checked, up to
// max_signs of them.
FieldErrors CheckField(const TriangleMesh& mesh, const LevelSet& field, const BruteForce& brute,
                       const ExactSides* sides, double pairs, size_t max_signs);

}  // namespace glint::benchmark
