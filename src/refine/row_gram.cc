#include "refine/row_gram.h"

#include "refine/band_transfer.h"

namespace glint {

RowGram RowGram::Restricted(const BandTransfer& transfer) const {
  const size_t num_coarse = transfer.coarse().size();
  const RowGram half = Make(begin_.size() - 1, num_coarse, [&](size_t i, const auto& add) {
    ForEntries(i, [&](int32_t j, double value) {
      transfer.ForParents(static_cast<size_t>(j), [&](int32_t parent, double weight) { add(parent, weight * value); });
    });
  });
  return Make(num_coarse, num_coarse, [&](size_t c, const auto& add) {
    transfer.ForChildren(c, [&](size_t child, double weight) {
      half.ForEntries(child, [&](int32_t column, double value) { add(column, weight * value); });
    });
  });
}

}  // namespace glint
