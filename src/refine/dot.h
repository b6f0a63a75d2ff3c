#pragma once

#include <cstddef>
#include <vector>

#include "core/parallel.h"

namespace glint {

// Inner product of two vectors of one length, summed in double in an order that no number of threads changes.
template <class T>
double Dot(const std::vector<T>& a, const std::vector<T>& b) {
  return ParallelSum(a.size(), 1 << 13, 0.0, [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) sum += static_cast<double>(a[i]) * b[i];
    return sum;
  });
}

}  // namespace glint
