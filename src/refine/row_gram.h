// Rows of a least-squares problem, multiplied out.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/parallel.h"

namespace glint {

class BandTransfer;

// Σ_r weight_r c_r c_rᵀ over the voxels of a band, row by row: what its products take does not depend on how many
// measurements have been added up. Sums in a fixed order.
class RowGram {
 public:
  RowGram() = default;

  // produce(i, add) calls add(column, value) for what is to be summed up in row i.
  template <class Produce>
  static RowGram Make(size_t num_rows, size_t num_columns, const Produce& produce);

  // Pᵀ G P.
  RowGram Restricted(const BandTransfer& transfer) const;

  template <class T>
  double Product(size_t i, const std::vector<T>& phi) const {
    double sum = 0;
    for (size_t e = begin_[i]; e < begin_[i + 1]; ++e) sum += value_[e] * static_cast<double>(phi[column_[e]]);
    return sum;
  }
  double AbsoluteSum(size_t i) const {
    double sum = 0;
    for (size_t e = begin_[i]; e < begin_[i + 1]; ++e) sum += std::abs(value_[e]);
    return sum;
  }
  template <class Visit>
  void ForEntries(size_t i, const Visit& visit) const {
    for (size_t e = begin_[i]; e < begin_[i + 1]; ++e) visit(column_[e], value_[e]);
  }

 private:
  std::vector<size_t> begin_ = {0};
  std::vector<int32_t> column_;
  std::vector<double> value_;
};

template <class Produce>
RowGram RowGram::Make(size_t num_rows, size_t num_columns, const Produce& produce) {
  // Each chunk has a table as long as there are columns: not too many of them.
  const size_t chunk = std::max<size_t>(1 << 12, num_rows / 64), num_chunks = (num_rows + chunk - 1) / chunk;
  std::vector<RowGram> parts(num_chunks);
  ParallelFor(num_chunks, 1, [&](size_t p) {
    RowGram& part = parts[p];
    std::vector<int64_t> slot(num_columns, -1);  // where the column's sum is
    for (size_t i = p * chunk; i < std::min(num_rows, (p + 1) * chunk); ++i) {
      const size_t first = part.column_.size();
      produce(i, [&](int32_t column, double value) {
        int64_t& at = slot[static_cast<size_t>(column)];
        if (at < 0) {
          at = static_cast<int64_t>(part.column_.size());
          part.column_.push_back(column);
          part.value_.push_back(0);
        }
        part.value_[static_cast<size_t>(at)] += value;
      });
      for (size_t e = first; e < part.column_.size(); ++e) slot[static_cast<size_t>(part.column_[e])] = -1;
      part.begin_.push_back(part.column_.size());
    }
  });
  RowGram out;
  for (RowGram& part : parts) {
    const size_t before = out.column_.size();
    for (size_t i = 1; i < part.begin_.size(); ++i) out.begin_.push_back(before + part.begin_[i]);
    out.column_.insert(out.column_.end(), part.column_.begin(), part.column_.end());
    out.value_.insert(out.value_.end(), part.value_.begin(), part.value_.end());
    part = RowGram();
  }
  return out;
}

}  // namespace glint
