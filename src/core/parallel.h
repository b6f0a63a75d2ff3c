// Deterministic parallel loops: the same result at any number of threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace glint {

// Calls body(begin, end) over disjoint chunks that cover [0, count); a chunk has at most `grain` items.
// Chunk borders depend on `count` and `grain` alone. The first exception thrown is rethrown here.
void ParallelChunks(size_t count, size_t grain, const std::function<void(size_t, size_t)>& body);

// Calls body(i) for every i in [0, count).
template <class Body>
void ParallelFor(size_t count, size_t grain, const Body& body) {
  ParallelChunks(count, grain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) body(i);
  });
}

// Sum (or any fold by operator+=) of value(begin, end) over chunks, added up in the order of the chunks,
// so that floating-point results do not depend on the number of threads.
template <class T, class Value>
T ParallelSum(size_t count, size_t grain, T zero, const Value& value) {
  grain = std::max<size_t>(grain, 1);
  const size_t num_chunks = (count + grain - 1) / grain;
  std::vector<T> partial(num_chunks, zero);
  ParallelChunks(num_chunks, 1, [&](size_t first, size_t last) {
    for (size_t c = first; c < last; ++c) partial[c] = value(c * grain, std::min(count, (c + 1) * grain));
  });
  T sum = zero;
  for (const T& p : partial) sum += p;
  return sum;
}

// Limits the number of threads of all parallel work while it lives. 0: as many as the machine has.
class ThreadLimit {
 public:
  explicit ThreadLimit(int num_threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* control_;
};

// The number of threads that parallel work may use now.
int NumThreads();

}  // namespace glint
