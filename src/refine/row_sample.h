// Fewer rows that stand for many in the same place: for a preconditioner, whose coarse bands need not know every point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "refine/band_rows.h"

namespace glint {

class RowSample {
 public:
  // Of the rows of values, and of those of derivatives, whose first voxel is the same about `max_rows` at most, evenly
  // picked.
  RowSample(const BandRows& rows, size_t num_voxels, size_t max_rows);

  bool All() const { return taken_.size() == place_.size(); }
  // The rows that were taken. Their weights are those of `weight`, and bear the weight of the others in their place,
  // too.
  BandRows Taken(const BandRows& rows) const;
  std::vector<double> Weights(const std::vector<double>& weight) const;

 private:
  std::vector<size_t> taken_;   // ascending
  std::vector<int32_t> place_;  // of each row: its first voxel and its kind
  size_t num_places_;
};

}  // namespace glint
