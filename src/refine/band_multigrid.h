// One multigrid cycle over ever coarser bands, as a preconditioner for conjugate gradients.
#pragma once

#include <memory>
#include <vector>

#include "refine/band_operator.h"

namespace glint {

// Coarse voxels are 2³ fine ones; between them functions are quadratic B-splines, whose bending energy on the fine
// band is that of the coarse one (piecewise linear ones have twice as much, and the cycle would not converge for a
// fourth-order operator). Smoothing is Chebyshev's polynomial in the matrix scaled by its absolute row sums, so that no
// eigenvalue needs estimating; rows are restricted exactly, but where a few places have very many a sample of those
// (where all do, they are multiplied out), the other terms are discretised anew. What that makes too long or too short,
// voxels that are held above all, is mended: each coarse correction is as long as lowers the energy most, and is made
// of two cycles of the coarse band, as directions of conjugate gradients (a K-cycle: Notay and Vassilevski 2008). So
// every step of a cycle lowers the energy, and z · r > 0; but the map is not linear, and the iteration around it has to
// be a flexible one. Deterministic. Memory: about 110 bytes a voxel of the finest band.
class BandMultigrid {
 public:
  // Keeps a reference to `finest`.
  explicit BandMultigrid(const BandOperator& finest);
  ~BandMultigrid();

  // After the row weights of `finest` have changed.
  void UpdateRowWeights();

  // z ≈ A⁻¹ r.
  void Apply(const std::vector<double>& r, std::vector<double>& z);

  size_t num_levels() const { return levels_.size(); }

 private:
  struct Level;
  void Cycle(size_t level);        // x from b, of that level; the finest leaves b as it is
  void Accelerated(size_t level);  // the same by two cycles, as directions of conjugate gradients; spoils b
  void FactorCoarsest();

  std::vector<std::unique_ptr<Level>> levels_;
};

}  // namespace glint
