#include "refine/row_sample.h"

#include "core/check.h"

namespace glint {

RowSample::RowSample(const BandRows& rows, size_t num_voxels, size_t max_rows)
    : place_(rows.size()), num_voxels_(num_voxels) {
  std::vector<size_t> count(num_voxels, 0), seen(num_voxels, 0);
  for (size_t r = 0; r < rows.size(); ++r) {
    place_[r] = rows.begin[r] < rows.begin[r + 1] ? rows.voxel[rows.begin[r]] : 0;
    ++count[place_[r]];
  }
  for (size_t r = 0; r < rows.size(); ++r) {
    const size_t here = place_[r], k = seen[here]++;
    if (count[here] <= max_rows || (k + 1) * max_rows / count[here] > k * max_rows / count[here]) taken_.push_back(r);
  }
}

BandRows RowSample::Taken(const BandRows& rows) const {
  BandRows out;
  const std::vector<double> weights = Weights(rows.weight);
  for (size_t k = 0; k < taken_.size(); ++k) {
    const size_t r = taken_[k];
    for (size_t e = rows.begin[r]; e < rows.begin[r + 1]; ++e) {
      out.voxel.push_back(rows.voxel[e]);
      out.coefficient.push_back(rows.coefficient[e]);
    }
    out.Close(rows.target[r], weights[k]);
  }
  return out;
}

std::vector<double> RowSample::Weights(const std::vector<double>& weight) const {
  GLINT_CHECK_EQ(weight.size(), place_.size());
  if (All()) return weight;
  std::vector<double> all(num_voxels_, 0), taken(num_voxels_, 0);
  std::vector<size_t> count(num_voxels_, 0);
  for (size_t r = 0; r < weight.size(); ++r) all[place_[r]] += weight[r];
  for (size_t r : taken_) {
    taken[place_[r]] += weight[r];
    ++count[place_[r]];
  }
  std::vector<double> out;
  out.reserve(taken_.size());
  for (size_t r : taken_) {
    const size_t here = place_[r];
    out.push_back(taken[here] > 0 ? weight[r] * (all[here] / taken[here])
                                  : all[here] / static_cast<double>(count[here]));
  }
  return out;
}

}  // namespace glint
