#include "core/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include "core/error.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void Fail(const fs::path& path, const char* what, int error) {
  throw InputError(path.string(), "", std::string(what) + ": " + std::strerror(error));
}

void SyncToDisk(const fs::path& file, const fs::path& reported_as) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) Fail(reported_as, "cannot be written", errno);
  const int result = ::fsync(fd);
  const int error = errno;
  ::close(fd);
  // Some file systems cannot sync (EINVAL, EROFS); an I/O error or a full disk must not pass unseen.
  if (result != 0 && error != EINVAL && error != EROFS && error != ENOTSUP) {
    Fail(reported_as, "cannot be written", error);
  }
}

// Removes the temporary file unless it has been renamed.
struct TemporaryFile {
  fs::path path;
  ~TemporaryFile() {
    if (path.empty()) return;
    std::error_code ignored;
    fs::remove(path, ignored);
  }
};

fs::path TemporaryName(const fs::path& path) {
  static std::atomic<uint64_t> counter{0};
  const std::string unique = std::to_string(::getpid()) + "-" + std::to_string(counter++);
  // The name stays short so that it fits wherever the final name fits; the extension tells libraries the format.
  return path.parent_path() / (".tmp-" + unique + path.extension().string());
}

}  // namespace

void WriteNamedFileAtomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  std::error_code error;
  if (fs::is_directory(path, error)) throw InputError(path.string(), "", "expected a file name, found a folder");
  if (path.has_parent_path()) {
    fs::create_directories(path.parent_path(), error);
    if (error) throw InputError(path.parent_path().string(), "", "cannot create the folder: " + error.message());
  }
  TemporaryFile temporary{TemporaryName(path)};
  write(temporary.path);
  SyncToDisk(temporary.path, path);
  fs::rename(temporary.path, path, error);
  if (error) throw InputError(path.string(), "", "cannot be written: " + error.message());
  temporary.path.clear();
  SyncToDisk(path.has_parent_path() ? path.parent_path() : fs::path("."), path);
}

void WriteFileAtomically(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  WriteNamedFileAtomically(path, [&](const fs::path& temporary) {
    errno = 0;
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    if (!out) Fail(path, "cannot be written", errno);
    write(out);
    out.flush();
    const int error = errno;
    if (!out) Fail(path, "cannot be written", error != 0 ? error : EIO);
    out.close();
    if (!out) Fail(path, "cannot be written", errno != 0 ? errno : EIO);
  });
}

void WriteFileAtomically(const fs::path& path, std::string_view bytes) {
  WriteFileAtomically(path,
                      [&](std::ostream& out) { out.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); });
}

}  // namespace glint
