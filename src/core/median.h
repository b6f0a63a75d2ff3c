// The median of a set of values.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace glint {

// The upper one of the two in the middle if their number is even; 0 if there is none.
inline double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace glint
