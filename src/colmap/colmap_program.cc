#include "colmap/colmap_program.h"

#include <fmt/format.h>

#include <charconv>

#include "core/error.h"

namespace glint {
namespace {

constexpr double kHelpLimitS = 60;

}  // namespace

ColmapProgram::ColmapProgram(const std::string& name, const Progress& progress) : file_(FindProgram(name)) {
  if (file_.empty())
    throw InputError(name, "",
                     "expected the program COLMAP, which makes a model of photographs, found none; install it with\n"
                     "  sudo apt-get install colmap\n"
                     "(elsewhere than Debian and Ubuntu see https://colmap.github.io/install.html) or name its file "
                     "with --set photos.colmap.program=FILE");
  const std::string help = Printed({"help"}, progress);
  has_cuda_ = help.find("with CUDA") != std::string::npos;
  const size_t at = help.find("COLMAP ");
  if (at == std::string::npos)
    throw InputError(file_.string(), "help", "expected the program COLMAP, it prints: " + help.substr(0, 200));
  version_ = help.substr(at + 7, help.find_first_of(" \n", at + 7) - at - 7);
}

std::string ColmapProgram::Printed(const std::vector<std::string>& arguments, const Progress& progress) const {
  std::string text;
  std::vector<std::string> command = {file_.string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  const ChildResult result = RunChild(
      command, {.environment = {{"QT_QPA_PLATFORM", "offscreen"}}, .log = {}, .time_limit_s = kHelpLimitS},
      [&](std::string_view line) { text.append(line) += '\n'; }, progress);
  if (!result.ok())
    throw InputError(file_.string(), arguments.back(),
                     fmt::format("expected the program COLMAP, it does not run here: {}", result.tail));
  return text;
}

const std::string& ColmapProgram::Help(const std::string& command, const Progress& progress) const {
  const auto known = help_.find(command);
  return known != help_.end() ? known->second : help_[command] = Printed({command, "-h"}, progress);
}

std::vector<std::string> ColmapProgram::Option(const std::string& command, const std::vector<std::string>& names,
                                               const std::string& value, const Progress& progress) const {
  const std::string& help = Help(command, progress);
  for (const std::string& name : names)
    if (help.find("--" + name + " ") != std::string::npos) return {"--" + name, value};
  return {};
}

ChildResult ColmapProgram::Run(const std::string& command, const std::vector<std::string>& arguments,
                               ChildOptions options, const std::function<void(std::string_view)>& on_line,
                               const Progress& progress) const {
  std::vector<std::string> line = {file_.string(), command};
  line.insert(line.end(), arguments.begin(), arguments.end());
  // Without a screen; SIFT on the processor or by CUDA needs none.
  options.environment.emplace_back("QT_QPA_PLATFORM", "offscreen");
  return RunChild(line, options, on_line, progress);
}

size_t CountAfter(std::string_view line, std::string_view what) {
  const size_t at = line.find(what);
  if (at == std::string_view::npos) return 0;
  const size_t digit = line.find_first_of("0123456789", at + what.size());
  if (digit == std::string_view::npos) return 0;
  size_t count = 0;
  std::from_chars(line.data() + digit, line.data() + line.size(), count);
  return count;
}

}  // namespace glint
