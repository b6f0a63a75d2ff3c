// A shell script in place of the program `colmap`, which plays one part at a time.
#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace glint::testing_support {

// Written as FOLDER/colmap. It notes each call in FOLDER/calls, keeps FOLDER/model as what the mapper makes (a folder
// of sub-models), and does `instead`, shell code, in place of the command of that name.
class FakeColmap {
 public:
  explicit FakeColmap(const std::filesystem::path& folder) : folder_(folder) {
    std::filesystem::create_directories(folder_ / "model");
    Write("", "");
  }

  void Write(const std::string& command, const std::string& instead) const {
    std::ofstream script(Program());
    script << "#!/bin/bash\n"
           << "here=" << folder_ << "\n"
           << "if [[ $1 == help ]]; then echo 'COLMAP 3.8 (Commit Unknown without CUDA)'; exit; fi\n"
           << "if [[ $2 == -h ]]; then echo '  --SiftExtraction.use_gpu arg  --SiftMatching.use_gpu arg '; exit; fi\n"
           << "echo \"$1\" >> $here/calls; echo \"$*\" >> $here/lines\n"
           << "arg() { while (($#)); do [[ $1 == $name ]] && echo \"$2\"; shift; done; }\n";
    if (!command.empty()) script << "if [[ $1 == " << command << " ]]; then " << instead << "\nfi\n";
    script << "case $1 in\n"
              "feature_extractor) n=$(wc -l < $(name=--image_list_path; arg \"$@\"))\n"
              "  for ((i = 1; i <= n; ++i)); do echo \"Processed file [$i/$n]\"; echo '  Features:        90'; done;;\n"
              "exhaustive_matcher) echo 'Matching block [1/1, 1/1] in 0.1s';;\n"
              "mapper) cp -r $here/model/. $(name=--output_path; arg \"$@\");;\n"
              "esac\n";
    script.close();
    std::filesystem::permissions(Program(), std::filesystem::perms::owner_all);
  }

  std::string Program() const { return (folder_ / "colmap").string(); }
  std::filesystem::path Model() const { return folder_ / "model"; }

  // The commands that were called since the last look.
  std::vector<std::string> Calls() const {
    std::vector<std::string> calls;
    std::ifstream in(folder_ / "calls");
    for (std::string line; std::getline(in, line);) calls.push_back(line);
    std::filesystem::remove(folder_ / "calls");
    return calls;
  }
  // With their arguments, of all calls.
  std::string Lines() const {
    std::stringstream text;
    text << std::ifstream(folder_ / "lines").rdbuf();
    return text.str();
  }

 private:
  std::filesystem::path folder_;
};

// Whether the process runs whose number the file holds; one that has ended and waits to be collected does not.
inline bool RunsNow(const std::filesystem::path& pid_file) {
  std::string pid, program, state;
  std::ifstream(pid_file) >> pid;
  std::ifstream("/proc/" + pid + "/stat") >> pid >> program >> state;
  return !state.empty() && state != "Z";
}

// Whether it goes on for seconds: a signal that was sent ends a process a moment later.
inline bool Runs(const std::filesystem::path& pid_file) {
  for (int i = 0; i < 250 && RunsNow(pid_file); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  return RunsNow(pid_file);
}

}  // namespace glint::testing_support
