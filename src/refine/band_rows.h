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

// Puts rows together: what is said of one voxel several times becomes one coefficient.
class RowBuilder {
 public:
  explicit RowBuilder(size_t num_voxels) : slot_(num_voxels, -1) {}

  void Push(int32_t v, double c) {
    int32_t& slot = slot_[static_cast<size_t>(v)];
    if (slot < 0) {
      slot = static_cast<int32_t>(voxel_.size());
      voxel_.push_back(v);
      sum_.push_back(c);
    } else {
      sum_[static_cast<size_t>(slot)] += c;
    }
  }
  void Close(double target, double weight, BandRows& rows) {
    for (size_t e = 0; e < voxel_.size(); ++e) {
      rows.Push(voxel_[e], sum_[e]);
      slot_[static_cast<size_t>(voxel_[e])] = -1;
    }
    rows.Close(target, weight);
    voxel_.clear();
    sum_.clear();
  }

 private:
  std::vector<int32_t> slot_;  // of each voxel of the band, where its sum is; -1: not in this row
  std::vector<int32_t> voxel_;
  std::vector<double> sum_;
};

}  // namespace glint
