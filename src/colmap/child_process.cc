#include "colmap/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>

#include "core/error.h"

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kPollMs = 100;
constexpr std::chrono::milliseconds kShortly(5);  // between looks at a program that is about to end
constexpr std::chrono::seconds kGraceToEnd(5);
constexpr size_t kTailLines = 8;

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::vector<std::string> Environment(const std::vector<std::pair<std::string, std::string>>& more) {
  std::vector<std::string> environment;
  for (char** entry = environ; *entry; ++entry) {
    const std::string_view text(*entry);
    bool replaced = false;
    for (const auto& [name, value] : more) replaced = replaced || text.starts_with(name + "=");
    if (!replaced) environment.emplace_back(text);
  }
  for (const auto& [name, value] : more) environment.emplace_back(name).append("=").append(value);
  return environment;
}

std::vector<char*> Pointers(std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  for (std::string& s : strings) pointers.push_back(s.data());
  pointers.push_back(nullptr);
  return pointers;
}

// A running program and the pipe that its output comes through.
class Child {
 public:
  Child(std::vector<std::string> command, const ChildOptions& options) {
    std::vector<std::string> environment = Environment(options.environment);
    const std::vector<char*> arguments = Pointers(command), variables = Pointers(environment);
    std::array<int, 2> out, failed;
    if (::pipe2(out.data(), O_CLOEXEC) != 0 || ::pipe2(failed.data(), O_CLOEXEC) != 0)
      throw InputError(command.front(), "", fmt::format("cannot be run: {}", std::strerror(errno)));
    pid_ = ::fork();
    if (pid_ == 0) Become(arguments, variables, out[1], failed[1]);
    const int fork_error = errno;
    ::close(out[1]);
    ::close(failed[1]);
    output_ = out[0];
    int error = pid_ < 0 ? fork_error : 0;
    if (pid_ > 0 && ::read(failed[0], &error, sizeof(error)) != sizeof(error)) error = 0;
    ::close(failed[0]);
    if (error == 0) return;
    ::close(output_);
    if (pid_ > 0) ::waitpid(pid_, nullptr, 0);
    throw InputError(command.front(), "", fmt::format("cannot be run: {}", std::strerror(error)));
  }
  ~Child() {
    if (!ended_) End();
    ::close(output_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // What it has printed within a moment; empty if nothing.
  std::string Read() {
    pollfd waiting = {output_, POLLIN, 0};
    std::string bytes(1 << 14, '\0');
    if (closed_ || ::poll(&waiting, 1, kPollMs) <= 0) {
      if (closed_) std::this_thread::sleep_for(kShortly);
      return "";
    }
    const ssize_t count = ::read(output_, bytes.data(), bytes.size());
    closed_ = count == 0;
    bytes.resize(count > 0 ? static_cast<size_t>(count) : 0);
    return bytes;
  }

  bool Ended() {
    if (!ended_ && ::waitpid(pid_, &status_, WNOHANG) == pid_) ended_ = true;
    return ended_;
  }

  // Asks the program and all that it started to end, then makes them.
  void End() {
    ::kill(-pid_, SIGTERM);
    const auto start = Clock::now();
    while (!Ended() && Clock::now() - start < kGraceToEnd) std::this_thread::sleep_for(kShortly);
    ::kill(-pid_, SIGKILL);
    if (!ended_) ::waitpid(pid_, &status_, 0);
    ended_ = true;
  }

  // Clock ticks of processor time that it and its ended children have used.
  long ProcessorTicks() const {
    std::ifstream file(fmt::format("/proc/{}/stat", pid_));
    std::string text((std::istreambuf_iterator<char>(file)), {});
    const size_t name_end = text.rfind(')');  // the program's name may hold anything
    if (name_end == std::string::npos) return 0;
    std::istringstream fields(text.substr(name_end + 1));
    std::string skipped;
    for (int i = 3; i < 14; ++i) fields >> skipped;
    long sum = 0, ticks = 0;
    for (int i = 0; i < 4 && fields >> ticks; ++i) sum += ticks;
    return sum;
  }

  int status() const { return status_; }

 private:
  // In the new process: only calls that are safe between fork and exec.
  [[noreturn]] static void Become(const std::vector<char*>& arguments, const std::vector<char*>& variables, int output,
                                  int failed) {
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) ::signal(signal, SIG_DFL);
    const int nothing = ::open("/dev/null", O_RDONLY);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(output, STDOUT_FILENO);
    ::dup2(output, STDERR_FILENO);
    ::execve(arguments.front(), arguments.data(), variables.data());
    const int error = errno;
    [[maybe_unused]] const ssize_t told = ::write(failed, &error, sizeof(error));
    ::_exit(127);
  }

  pid_t pid_ = -1;
  int output_ = -1;
  bool closed_ = false, ended_ = false;
  int status_ = 0;
};

// Cuts what comes in into lines, for the log, the caller and the tail.
class Lines {
 public:
  Lines(const std::filesystem::path& log, const std::function<void(std::string_view)>& on_line) : on_line_(on_line) {
    if (log.empty()) return;
    log_.open(log, std::ios::app | std::ios::binary);
    if (!log_) throw InputError(log.string(), "", "the log cannot be written");
  }

  void Add(const std::string& bytes) {
    if (log_.is_open()) log_ << bytes << std::flush;
    for (const char c : bytes) {
      if (c != '\n' && c != '\r') {
        line_ += c;
      } else {
        Flush();
      }
    }
  }

  void Flush() {
    if (line_.find_first_not_of(" \t") != std::string::npos) {
      on_line_(line_);
      tail_.push_back(line_);
      if (tail_.size() > kTailLines) tail_.erase(tail_.begin());
    }
    line_.clear();
  }

  std::string Tail() const {
    std::string text;
    for (const std::string& line : tail_) text += (text.empty() ? "" : "\n") + line;
    return text;
  }

 private:
  const std::function<void(std::string_view)>& on_line_;
  std::ofstream log_;
  std::string line_;
  std::vector<std::string> tail_;
};

}  // namespace

ChildResult RunChild(const std::vector<std::string>& command, const ChildOptions& options,
                     const std::function<void(std::string_view)>& on_line, const Progress& progress) {
  Lines lines(options.log, on_line);
  Child child(command, options);
  const auto start = Clock::now();
  auto alive = start;
  long ticks = 0;
  ChildResult result;
  for (bool ended = false; !ended;) {
    progress.ThrowIfCancelled();  // ends the child on its way out
    ended = child.Ended();        // before reading: what it printed last is read once more
    const std::string bytes = child.Read();
    lines.Add(bytes);
    if (!bytes.empty()) ended = false;
    const long now = child.ProcessorTicks();
    if (now != ticks || !bytes.empty()) alive = Clock::now();
    ticks = now;
    if (ended) break;
    const bool stalled = options.stall_limit_s > 0 && SecondsSince(alive) > options.stall_limit_s;
    const bool too_long = options.time_limit_s > 0 && SecondsSince(start) > options.time_limit_s;
    if (!stalled && !too_long) continue;
    result.end = stalled ? ChildEnd::kStalled : ChildEnd::kTooLong;
    child.End();
    break;
  }
  lines.Flush();
  result.tail = lines.Tail();
  if (result.end != ChildEnd::kExited) return result;
  if (WIFSIGNALED(child.status())) result.end = ChildEnd::kSignal;
  result.code = WIFSIGNALED(child.status()) ? WTERMSIG(child.status()) : WEXITSTATUS(child.status());
  return result;
}

std::filesystem::path FindProgram(const std::string& name) {
  const auto runnable = [](const std::filesystem::path& file) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(file, ignored) && ::access(file.c_str(), X_OK) == 0;
  };
  if (name.find('/') != std::string::npos) return runnable(name) ? std::filesystem::path(name) : "";
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::filesystem::path file = std::filesystem::path(folder.empty() ? "." : folder) / name;
    if (runnable(file)) return file;
  }
  return {};
}

}  // namespace glint
