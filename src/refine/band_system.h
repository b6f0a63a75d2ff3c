// A linear least-squares problem over the voxels of a band, matrix-free: the level set's energy for fixed contacts
// (DESIGN 3.4, "variational") is one of these.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "refine/band.h"

namespace glint {

// Σ_r weight_r (Σ_e coefficient_e φ[voxel_e] − target_r)², stored row by row.
struct BandRows {
  std::vector<size_t> begin = {0};
  std::vector<int32_t> voxel;
  std::vector<float> coefficient;
  std::vector<double> target;
  std::vector<double> weight;

  size_t size() const { return target.size(); }
  void Push(int32_t v, double c) {
    voxel.push_back(v);
    coefficient.push_back(static_cast<float>(c));
  }
  void Close(double row_target, double row_weight) {
    begin.push_back(voxel.size());
    target.push_back(row_target);
    weight.push_back(row_weight);
  }
  double Dot(size_t row, const std::vector<double>& phi) const;
};

// Weights of the terms that every voxel has.
struct BandWeights {
  double smoothness = 1;           // of ‖h² Hφ‖², second differences; mixed ones at the centres of voxel faces
  double normal = 0;               // of (h ∂φ/∂n − h)², which keeps |∇φ| near 1
  std::vector<Eigen::Vector3f> n;  // unit normals of the current surface, a voxel
  std::vector<float> pull;         // of (φ − pull_target)², a voxel
  std::vector<float> pull_target;
};

struct SolveReport {
  int iterations = 0;
  double relative_residual = 0;
  double initial_energy = 0;
  double final_energy = 0;
};

// A difference that needs a voxel off the band is left out: natural boundary conditions.
// Work: about 150 flops a voxel and product; memory 28 bytes a voxel besides the vectors.
class BandSystem {
 public:
  BandSystem(const Band& band, BandWeights weights);

  // The sparse rows; may be replaced between solves (re-weighting).
  void SetRows(BandRows rows);

  double Energy(const std::vector<double>& phi) const;

  // Conjugate gradients, preconditioned by the diagonal, from phi until the residual has fallen by `tolerance`.
  SolveReport Solve(int max_iterations, double tolerance, std::vector<double>& phi) const;

 private:
  void Apply(const std::vector<double>& phi, std::vector<double>& out) const;  // normal matrix times phi
  void Differences(const std::vector<double>& phi) const;
  double GatherDifferences(size_t i) const;
  void BuildRightHandSide();
  void BuildDiagonal();

  const Band& band_;
  const BandWeights weights_;
  BandRows rows_;
  std::vector<uint8_t> interior_;  // all six neighbours are in the band
  // Rows by voxel, so that their transposed product is a gather.
  std::vector<size_t> by_voxel_begin_;
  std::vector<int32_t> by_voxel_row_;
  std::vector<float> by_voxel_coefficient_;
  std::vector<double> rhs_;
  std::vector<double> inverse_diagonal_;
  // Scratch of Apply: three second differences, three mixed ones and the normal derivative a voxel.
  mutable std::vector<std::array<float, 7>> differences_;
  mutable std::vector<double> row_products_;
};

}  // namespace glint
