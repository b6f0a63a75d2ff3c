// Runs the program `glint` as a user does, for tests end to end.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace glint {

inline std::string ReadText(const std::filesystem::path& path) {
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

struct ProgramResult {
  int exit_code = -1;
  std::string out;  // standard output
  std::string err;  // standard error
};

// `prefix` goes before the program, for example "ulimit -v 1000000;".
inline ProgramResult RunGlint(const std::vector<std::string>& arguments, const std::string& prefix = "") {
  const std::string base = ::testing::TempDir() + "glint_program_" + std::to_string(::getpid());
  std::string command = prefix + " '" GLINT_PROGRAM "'";
  for (const std::string& argument : arguments) command += " '" + argument + "'";
  command += " > '" + base + ".out' 2> '" + base + ".err' < /dev/null";
  const int status = std::system(command.c_str());
  ProgramResult result;
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  result.out = ReadText(base + ".out");
  result.err = ReadText(base + ".err");
  std::filesystem::remove(base + ".out");
  std::filesystem::remove(base + ".err");
  return result;
}

// A prefix for RunGlint(): Ctrl-C once `condition` holds, words of the shell without single quotes; within a minute.
inline std::string InterruptWhen(const std::string& condition) {
  return "sh -c '\"$@\" & for i in $(seq 3000); do " + condition +
         " && break; sleep 0.02; done; kill -INT $!; wait $!' sh";
}

// A folder of its own for the test that runs, removed with it.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("glint_") + info->test_suite_name() + "_" + info->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~ProgramTest() override { std::filesystem::remove_all(folder_); }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  void Write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  std::filesystem::path folder_;
};

// No file of a result, finished or half-written.
inline void ExpectNoResults(const std::filesystem::path& out) {
  for (const char* name : {"mesh.ply", "sdf.vdb", "lights.json", "report.json"})
    EXPECT_FALSE(std::filesystem::exists(out / name)) << name;
  if (!std::filesystem::exists(out)) return;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(out))
    EXPECT_FALSE(entry.path().filename().string().starts_with(".tmp-")) << entry.path();
}

}  // namespace glint
