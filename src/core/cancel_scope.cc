#include "core/cancel_scope.h"

#include <utility>

namespace glint {
namespace {

thread_local const Progress* current = nullptr;

}  // namespace

CancelScope::CancelScope(const Progress& progress) : outer_(std::exchange(current, &progress)) {}
CancelScope::~CancelScope() { current = outer_; }
const Progress& CancelScope::Current() { return current ? *current : Progress::Silent(); }

}  // namespace glint
