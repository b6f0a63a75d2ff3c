#include "refine/row_sample.h"

#include <cmath>

#include "core/check.h"
#include "core/parallel.h"

namespace glint {

namespace {

constexpr double kGoldenRatio = 0.6180339887498949;

// Where a row is, and of which kind: what measures derivatives is weighted otherwise than what measures values, whose
// coefficients sum to 1 on every band.
int32_t PlaceOf(const BandRows& rows, size_t r) {
  if (rows.begin[r] == rows.begin[r + 1]) return 0;
  double sum = 0;
  for (size_t e = rows.begin[r]; e < rows.begin[r + 1]; ++e) sum += rows.coefficient[e];
  return 2 * rows.voxel[rows.begin[r]] + (std::abs(sum) < 0.5 ? 1 : 0);
}

}  // namespace

RowSample::RowSample(const BandRows& rows, size_t num_voxels, size_t max_rows)
    : place_(rows.size()), num_places_(2 * num_voxels) {
  std::vector<uint32_t> count(num_places_, 0), seen(num_places_, 0);
  ParallelFor(rows.size(), 1 << 13, [&](size_t r) { place_[r] = PlaceOf(rows, r); });
  for (const int32_t place : place_) ++count[place];
  for (size_t r = 0; r < rows.size(); ++r) {
    const int32_t here = place_[r];
    // Multiples of the golden ratio: evenly spread, and out of step with the three axes of a contact.
    const double turn = kGoldenRatio * seen[here]++;
    if ((turn - std::floor(turn)) * count[here] < static_cast<double>(max_rows)) taken_.push_back(r);
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
  std::vector<double> all(num_places_, 0), taken(num_places_, 0);
  std::vector<size_t> count(num_places_, 0);
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
