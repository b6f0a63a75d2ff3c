// What is in a file, as a short text; and which build of the program this is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace glint {

// Hashes of whole files (XXH3, 128 bits). A file whose size, time of change and inode are as they were when it was last
// read is not read again, so that a project of gigabytes is looked over in a moment. Thread-safe.
class FileHashes {
 public:
  // Goes on with what an earlier run remembered in `memory`; one that is not there or not sound only costs time.
  explicit FileHashes(std::filesystem::path memory);

  // Empty where there is no such file. Throws InputError where there is one that cannot be read.
  std::string Of(const std::filesystem::path& file);
  // One hash over names and contents of several files below `folder`, in the order given.
  std::string Of(const std::filesystem::path& folder, const std::vector<std::string>& names);

  // Remembers for the next run.
  void Save() const;

 private:
  struct Entry {
    uint64_t size = 0, inode = 0;
    int64_t changed_ns = 0, read_ns = 0;  // since 1970
    std::string hash;
  };
  const std::filesystem::path memory_;
  std::mutex mutex_;
  std::map<std::string, Entry> known_;  // by absolute path
};

// Tells builds of the program (or of the library that a program has loaded) apart: the linker's build id.
std::string BuildId();

}  // namespace glint
