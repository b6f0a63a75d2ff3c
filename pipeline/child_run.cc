#include "pipeline/child_run.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string_view>

#include "core/error.h"

namespace glint {
namespace {

constexpr int kPollEveryMs = 100;

[[noreturn]] void Fail() {
  throw InputError("", "a run of its own", std::string("cannot be started: ") + std::strerror(errno));
}

// In the child, between fork and exec: only what a signal handler may call. A process group of its own keeps a Ctrl-C
// at the terminal from reaching it directly: its parent asks it to stop, once.
[[noreturn]] void Become(char* const* arguments, int output, pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  const int nothing = ::open("/dev/null", O_RDWR);
  if (::getppid() == parent && nothing >= 0 && ::dup2(nothing, STDIN_FILENO) >= 0 &&
      ::dup2(output, STDOUT_FILENO) >= 0 && ::dup2(nothing, STDERR_FILENO) >= 0)
    ::execv("/proc/self/exe", arguments);
  ::_exit(127);
}

struct Descriptor {
  int fd = -1;
  void Close() {
    if (fd >= 0) ::close(fd);
    fd = -1;
  }
  ~Descriptor() { Close(); }
};

}  // namespace

int RunChild(const std::vector<std::string>& arguments, const std::function<void(const std::string&)>& line,
             const std::function<bool()>& cancelled) {
  std::vector<std::string> words = {"glint"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) Fail();
  Descriptor read_end{ends[0]}, write_end{ends[1]};
  const pid_t parent = ::getpid(), child = ::fork();
  if (child < 0) Fail();
  if (child == 0) Become(argv.data(), write_end.fd, parent);
  write_end.Close();

  std::string pending;
  std::array<char, 1 << 16> buffer;
  for (bool asked = false;;) {
    if (!asked && cancelled()) {
      ::kill(child, SIGTERM);
      asked = true;
    }
    pollfd waiting = {read_end.fd, POLLIN, 0};
    if (::poll(&waiting, 1, kPollEveryMs) <= 0) continue;
    const ssize_t size = ::read(read_end.fd, buffer.data(), buffer.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) break;
    pending.append(buffer.data(), static_cast<size_t>(size));
    for (size_t end; (end = pending.find('\n')) != std::string::npos; pending.erase(0, end + 1))
      line(pending.substr(0, end));
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace glint
