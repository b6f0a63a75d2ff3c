// A linear least-squares problem over the voxels of a band, matrix-free: the level set's energy for fixed contacts
// (DESIGN 3.4, "variational") is one of these.
#pragma once

#include <memory>
#include <vector>

#include "refine/band.h"
#include "refine/band_multigrid.h"
#include "refine/band_operator.h"

namespace glint {

struct SolveReport {
  int iterations = 0;
  double relative_residual = 0;
  double initial_energy = 0;
  double final_energy = 0;
};

// Memory: about 350 bytes a voxel with everything.
class BandSystem {
 public:
  BandSystem(const Band& band, BandWeights weights, BandRows rows = {});

  // Re-weighting; one weight a row.
  void SetRowWeights(const std::vector<double>& weight);
  const BandRows& rows() const { return operator_.rows(); }

  // Another field that costs no bending; the matrix stays as it is.
  void SetReference(std::vector<float> reference);

  double Energy(const std::vector<double>& phi) const;

  // Conjugate gradients, preconditioned by a multigrid cycle, from phi until the residual (in the norm of the
  // preconditioner) has fallen by `tolerance`.
  SolveReport Solve(int max_iterations, double tolerance, std::vector<double>& phi);

  // A random deviation from the minimum whose covariance is the inverse of the matrix, which it is of the field if
  // every term is a measurement with a variance of 1 / weight: the minimum for targets that are such noise (Papandreou
  // and Yuille 2010). `row_noise`: what else each row's target is off by, such as an error that many share.
  std::vector<double> Deviation(uint64_t seed, const std::vector<double>& row_noise, int max_iterations,
                                double tolerance);

 private:
  void BuildTargets();
  void BuildRightHandSide();
  // Conjugate gradients; fills all but the energies.
  SolveReport Minimize(const std::vector<double>& rhs, int max_iterations, double tolerance, std::vector<double>& phi);

  BandWeights weights_;
  BandOperator operator_;
  const float voxel_size_;
  std::unique_ptr<BandMultigrid> multigrid_;  // made by the first solve
  std::vector<BandOperator::Differences> target_differences_;
  std::vector<double> rhs_;
};

}  // namespace glint
