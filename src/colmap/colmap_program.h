// The installed program `colmap`.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "colmap/child_process.h"
#include "core/progress.h"

namespace glint {

class ColmapProgram {
 public:
  // `name`: found on the PATH, or the program's file. Throws InputError: there is none, and how to install it, or it
  // does not run.
  ColmapProgram(const std::string& name, const Progress& progress);

  const std::string& version() const { return version_; }  // "3.8"
  bool has_cuda() const { return has_cuda_; }

  // An option of `command` by the names that COLMAP's versions give it, the first that this one knows, as
  // {"--NAME", value}; empty if it knows none.
  std::vector<std::string> Option(const std::string& command, const std::vector<std::string>& names,
                                  const std::string& value, const Progress& progress) const;

  // Runs `colmap COMMAND ARGUMENTS`.
  ChildResult Run(const std::string& command, const std::vector<std::string>& arguments, ChildOptions options,
                  const std::function<void(std::string_view)>& on_line, const Progress& progress) const;

 private:
  const std::string& Help(const std::string& command, const Progress& progress) const;
  std::string Printed(const std::vector<std::string>& arguments, const Progress& progress) const;

  std::filesystem::path file_;
  std::string version_;
  bool has_cuda_ = false;
  mutable std::map<std::string, std::string> help_;  // of the commands that were asked for
};

// "[7/48" in a line that holds `what`, such as "Processed file [7/48]"; 0: not such a line.
size_t CountAfter(std::string_view line, std::string_view what);

}  // namespace glint
