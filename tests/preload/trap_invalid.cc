// Preloaded into a program (LD_PRELOAD): ends it with a trace at the first invalid floating-point operation (0/0, inf -
// inf, the root of a negative number, a comparison or a conversion of NaN) of the program's own code, with what it
// inlined, in whatever thread. Shared libraries may do as they like (Embree builds its trees with NaN in unused lanes):
// there the one instruction runs untrapped.
#include <execinfo.h>
#include <fenv.h>
#include <link.h>
#include <signal.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>

namespace {

constexpr uint32_t kInvalidFlag = 1, kInvalidMask = 1 << 7;  // of MXCSR
constexpr greg_t kSingleStep = 1 << 8;                       // of the processor's flags

uintptr_t program_begin = ~uintptr_t{0}, program_end = 0;

// The first object that is listed is the program.
int NoteProgram(dl_phdr_info* info, size_t, void*) {
  for (int i = 0; i < info->dlpi_phnum; ++i) {
    if (info->dlpi_phdr[i].p_type != PT_LOAD) continue;
    const uintptr_t begin = info->dlpi_addr + info->dlpi_phdr[i].p_vaddr;
    program_begin = std::min(program_begin, begin);
    program_end = std::max(program_end, begin + info->dlpi_phdr[i].p_memsz);
  }
  return 1;
}

void OnTrap(int, siginfo_t*, void* context) {
  mcontext_t& machine = static_cast<ucontext_t*>(context)->uc_mcontext;
  const auto at = static_cast<uintptr_t>(machine.gregs[REG_RIP]);
  if (at < program_begin || at >= program_end) {
    machine.fpregs->mxcsr |= kInvalidMask;
    machine.gregs[REG_EFL] |= kSingleStep;
    return;
  }
  constexpr char kMessage[] = "invalid floating-point operation\n";
  if (::write(STDERR_FILENO, kMessage, sizeof(kMessage) - 1) < 0) ::_exit(99);
  void* frames[64];
  ::backtrace_symbols_fd(frames, ::backtrace(frames, 64), STDERR_FILENO);
  ::_exit(98);
}

// After the one instruction.
void OnStep(int, siginfo_t*, void* context) {
  mcontext_t& machine = static_cast<ucontext_t*>(context)->uc_mcontext;
  machine.fpregs->mxcsr &= ~(kInvalidMask | kInvalidFlag);
  machine.gregs[REG_EFL] &= ~kSingleStep;
}

struct Trap {
  Trap() {
    ::dl_iterate_phdr(NoteProgram, nullptr);
    void* frame;
    ::backtrace(&frame, 1);  // loads what it needs now, not in the handler
    struct sigaction action = {};
    action.sa_flags = SA_SIGINFO;
    action.sa_sigaction = OnTrap;
    ::sigaction(SIGFPE, &action, nullptr);
    action.sa_sigaction = OnStep;
    ::sigaction(SIGTRAP, &action, nullptr);
    ::feenableexcept(FE_INVALID);
  }
};
const Trap trap;  // threads inherit it

}  // namespace
