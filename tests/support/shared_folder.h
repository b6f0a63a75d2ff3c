// A folder that is dear to make and that several tests look at, and leave as it is. ctest starts a process for each
// test: the first one that needs the folder makes it, in GLINT_SHARED_FOLDERS, while others wait; ctest removes them in
// the end (fixture `shared_folders`). Without ctest it is the process' own.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>

namespace glint::testing_support {

// `make` fills the folder, which exists and is empty. If it leaves a failed assertion, the next process makes it anew.
inline std::filesystem::path SharedFolder(const std::string& name,
                                          const std::function<void(const std::filesystem::path&)>& make) {
  namespace fs = std::filesystem;
  const char* shared = std::getenv("GLINT_SHARED_FOLDERS");
  const fs::path folder = fs::path(shared ? shared : ::testing::TempDir()) / name;
  fs::create_directories(folder.parent_path());
  const std::string lock_path = folder.string() + ".lock";
  const int lock = ::open(lock_path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  if (lock < 0 || ::flock(lock, LOCK_EX) != 0) throw std::runtime_error(lock_path + ": cannot be locked");
  const fs::path finished = folder.string() + ".finished";
  if (!fs::exists(finished)) {
    fs::remove_all(folder);
    fs::create_directories(folder);
    make(folder);
    if (!::testing::Test::HasFailure()) fs::create_directory(finished);
  }
  ::close(lock);
  return folder;
}

}  // namespace glint::testing_support
