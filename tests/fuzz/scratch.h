// Files for readers that want a path: in memory where the system has a folder for that.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

#include "core/error.h"

namespace glint::fuzz {

// A folder of this process, removed at its end.
class Scratch {
 public:
  static const std::filesystem::path& Folder() {
    static const Scratch scratch;
    return scratch.folder_;
  }

 private:
  Scratch() {
    std::error_code missing;
    const std::filesystem::path memory = "/dev/shm";
    const bool has_memory = ::access(memory.c_str(), W_OK) == 0 && std::filesystem::is_directory(memory, missing);
    folder_ = (has_memory ? memory : std::filesystem::temp_directory_path()) /
              std::string("glint_fuzz_").append(std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::filesystem::path folder_;
};

inline std::filesystem::path ScratchFile(const std::string& name, std::string_view bytes) {
  const std::filesystem::path path = Scratch::Folder() / name;
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return path;
}

inline std::string BytesOf(const std::filesystem::path& path) {
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// Runs a reader; a refusal is a fine answer as long as it says something.
template <class Read>
void Try(const Read& read) {
  try {
    read();
  } catch (const InputError& refusal) {
    if (std::string_view(refusal.what()).empty()) std::abort();
  }
}

}  // namespace glint::fuzz
