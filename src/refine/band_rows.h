// Sparse least-squares rows over the voxels of a band.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

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
  template <class T>
  double Dot(size_t row, const std::vector<T>& phi) const {
    double sum = 0;
    for (size_t e = begin[row]; e < begin[row + 1]; ++e) sum += coefficient[e] * static_cast<double>(phi[voxel[e]]);
    return sum;
  }
};

}  // namespace glint
