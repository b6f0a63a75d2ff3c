#include "pipeline/interrupt.h"

#include <atomic>
#include <csignal>

namespace glint {
namespace {

std::atomic<int> interrupt_signal{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may touch it");

void OnSignal(int signal) { interrupt_signal.store(signal); }

void Install(void (*handler)(int), int flags) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

// SA_RESETHAND: the second signal of a kind takes its default action, which ends the program.
InterruptGuard::InterruptGuard() { Install(&OnSignal, static_cast<int>(SA_RESETHAND) | SA_RESTART); }
InterruptGuard::~InterruptGuard() { Install(SIG_DFL, 0); }

int InterruptSignal() { return interrupt_signal.load(); }

}  // namespace glint
