#include "core/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

namespace glint {

void ParallelChunks(size_t count, size_t grain, const std::function<void(size_t, size_t)>& body) {
  grain = std::max<size_t>(grain, 1);
  const size_t num_chunks = (count + grain - 1) / grain;
  tbb::parallel_for(tbb::blocked_range<size_t>(0, num_chunks, 1), [&](const auto& range) {
    for (size_t c = range.begin(); c != range.end(); ++c) body(c * grain, std::min(count, (c + 1) * grain));
  });
}

ThreadLimit::ThreadLimit(int num_threads)
    : control_(new tbb::global_control(tbb::global_control::max_allowed_parallelism,
                                       num_threads > 0 ? num_threads : tbb::info::default_concurrency())) {}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

int NumThreads() {
  return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

}  // namespace glint
