#include <vector>

#include "core/parallel.h"
#include "refine/band_operator.h"

namespace glint {

// Products with unit vectors would look at every row for every voxel: with millions of rows that takes minutes. So
// those are for the differences alone, and of the rows each column gets those of its voxel. Added up in the order of
// Apply.
Eigen::MatrixXf BandOperator::Dense() const {
  const size_t n = topology_.size();
  Eigen::MatrixXf matrix(n, n);
  const BandOperator without_rows(topology_, weights_, BandRows());
  std::vector<float> unit(n, 0), column;
  for (size_t i = 0; i < n; ++i) {
    unit[i] = 1;
    without_rows.Apply(unit, column);
    unit[i] = 0;
    matrix.col(i) = Eigen::Map<const Eigen::VectorXf>(column.data(), n);
  }
  const RowGram* const gram = Crowded() ? &Gram() : nullptr;
  ParallelFor(n, 8, [&](size_t i) {
    std::vector<double> of_rows(n, 0);
    if (gram) gram->ForEntries(i, [&](int32_t j, double value) { of_rows[static_cast<size_t>(j)] = value; });
    for (size_t e = by_voxel_begin_[i]; !gram && e < by_voxel_begin_[i + 1];) {
      const size_t r = by_voxel_row_[e];
      double product = 0;  // a row may name a voxel twice
      for (; e < by_voxel_begin_[i + 1] && static_cast<size_t>(by_voxel_row_[e]) == r; ++e)
        product += by_voxel_coefficient_[e];
      product *= rows_.weight[r];
      for (size_t k = rows_.begin[r]; k < rows_.begin[r + 1]; ++k)
        of_rows[rows_.voxel[k]] += rows_.coefficient[k] * product;
    }
    for (size_t j = 0; j < n; ++j) matrix(j, i) = static_cast<float>(matrix(j, i) + of_rows[j]);
  });
  return matrix;
}

}  // namespace glint
