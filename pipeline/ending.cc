#include "pipeline/ending.h"

#include <filesystem>
#include <new>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "pipeline/interrupt.h"

namespace glint {
namespace {

// OpenCV says it in its own way.
bool IsOutOfMemory(const std::exception& e) {
  const auto* opencv = dynamic_cast<const cv::Exception*>(&e);
  return dynamic_cast<const std::bad_alloc*>(&e) || (opencv && opencv->code == cv::Error::StsNoMem);
}

}  // namespace

Ending EndingOf(const std::exception_ptr& exception) {
  try {
    std::rethrow_exception(exception);
  } catch (const InputError& e) {
    return {kBadInput, e.what()};
  } catch (const NoResultError& e) {
    return {kNoResult, e.what()};
  } catch (const CancelledError&) {
    return {128 + InterruptSignal(), "stopped on request; finished stages are kept"};
  } catch (const std::filesystem::filesystem_error& e) {
    return {kBadInput, e.what()};
  } catch (const std::exception& e) {
    if (IsOutOfMemory(e)) return {kBadInput, "out of memory: choose larger voxels or smaller images"};
    return {kBug, std::string("this is a bug in Glint, please report it: ") + e.what()};
  }
}

}  // namespace glint
