#include "core/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

#include "core/cancel_scope.h"

namespace glint {
namespace {

// TBB's library is not built for ThreadSanitizer, which does not see that a loop's work begins after its caller called
// and ends before it returns. Told here; nothing in other builds.
class LoopOrder {
 public:
#if defined(__SANITIZE_THREAD__)
  LoopOrder() { __tsan_release(&begin_); }
  ~LoopOrder() { __tsan_acquire(&end_); }
  void BeginWork() { __tsan_acquire(&begin_); }
  void EndWork() { __tsan_release(&end_); }

 private:
  char begin_ = 0, end_ = 0;
#else
  void BeginWork() {}
  void EndWork() {}
#endif
};

}  // namespace

void ParallelChunks(size_t count, size_t grain, const std::function<void(size_t, size_t)>& body) {
  grain = std::max<size_t>(grain, 1);
  const size_t num_chunks = (count + grain - 1) / grain;
  LoopOrder order;
  const Progress& asked = CancelScope::Current();
  tbb::parallel_for(tbb::blocked_range<size_t>(0, num_chunks, 1), [&](const auto& range) {
    order.BeginWork();
    const CancelScope scope(asked);  // for loops within this one, on whatever thread
    for (size_t c = range.begin(); c != range.end(); ++c) {
      asked.ThrowIfCancelled();
      body(c * grain, std::min(count, (c + 1) * grain));
    }
    order.EndWork();
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
