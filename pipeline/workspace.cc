#include "pipeline/workspace.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "core/error.h"
#include "core/inside.h"

namespace glint {
namespace fs = std::filesystem;
namespace {

// The names that core/atomic_file.h gives to files it is writing: ".tmp-PID-COUNT.EXTENSION".
bool IsTemporary(const fs::path& file) {
  const std::string stem = file.stem().string();
  return stem.starts_with(".tmp-") && stem.find_first_not_of("0123456789-", 5) == std::string::npos;
}

template <class Iterator>
void RemoveTemporaries(const fs::path& folder) {
  std::error_code error;
  for (Iterator it(folder, error); !error && it != Iterator(); it.increment(error)) {
    std::error_code ignored;
    if (it->is_regular_file(ignored) && IsTemporary(it->path())) fs::remove(it->path(), ignored);
  }
}

// An output folder may come from elsewhere, for example with a project that was downloaded.
void RefuseLinksOutOf(const fs::path& root, const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders)
    if (!LiesInside(folder, root))
      throw InputError(folder.string(), "", "is a link that leads out of the output folder; remove it");
}

}  // namespace

Workspace::Workspace(fs::path root) : root_(std::move(root)) {
  std::error_code error;
  if (fs::exists(root_, error) && !fs::is_directory(root_, error))
    throw InputError(root_.string(), "", "expected a folder for the output, found a file");
  fs::create_directories(root_, error);
  if (error) throw InputError(root_.string(), "", "the output folder cannot be made: " + error.message());
  RefuseLinksOutOf(root_, {Stages(), Overlays(), HighlightMasks()});
  folder_ = ::open(root_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder_ < 0 || ::access(root_.c_str(), W_OK | X_OK) != 0) {
    const int reason = errno;
    if (folder_ >= 0) ::close(folder_);
    throw InputError(root_.string(), "", fmt::format("the output folder cannot be written: {}", std::strerror(reason)));
  }
  // A file system that cannot lock folders (ENOTSUP, EBADF on some network shares) still serves one run at a time.
  if (::flock(folder_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(folder_);
    throw InputError(root_.string(), "", "another run of glint is writing here; wait for it or choose another -o");
  }
  // The log is appended to, not replaced as a whole: never at the end of a link.
  if (fs::is_symlink(Log(), error)) fs::remove(Log(), error);
  // Only where a run writes: the user may have named a folder that holds other things too.
  RemoveTemporaries<fs::directory_iterator>(root_);
  RemoveTemporaries<fs::directory_iterator>(Stages());
  fs::remove_all(StagedFiles(), error);
  RemoveTemporaries<fs::recursive_directory_iterator>(Overlays());
  RemoveTemporaries<fs::recursive_directory_iterator>(HighlightMasks());
}

Workspace::~Workspace() { ::close(folder_); }

bool Workspace::SetEarlierResultsAside(const std::vector<fs::path>& inputs) const {
  std::error_code error;
  if (!fs::exists(Mesh(), error)) return false;
  const fs::path earlier = root_ / "earlier";
  fs::create_directories(earlier, error);
  if (error) throw InputError(earlier.string(), "", "cannot be made: " + error.message());
  for (const fs::path& file :
       {Mesh(), MeshAs(".obj"), MeshAs(".glb"), LevelSetFile(), Lights(), Config(), Report(), ReportPage()}) {
    const bool is_input = std::any_of(inputs.begin(), inputs.end(), [&](const fs::path& input) {
      std::error_code missing;
      return fs::equivalent(input, file, missing);
    });
    if (is_input || !fs::exists(file, error)) continue;
    fs::rename(file, earlier / file.filename(), error);
    if (error) throw InputError(file.string(), "", "cannot be moved into earlier/: " + error.message());
  }
  return true;
}

Publication::Publication(const Workspace& out) : folder_(out.StagedFiles()) {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

fs::path Publication::For(const fs::path& file) {
  files_.emplace_back(folder_ / fmt::format("{}-{}", files_.size(), file.filename().string()), file);
  return files_.back().first;
}

void Publication::Publish() {
  for (const fs::path& file : gone_) {
    std::error_code error;
    fs::remove(file, error);
    if (error) throw InputError(file.string(), "", "cannot be removed: " + error.message());
  }
  for (const auto& [from, to] : files_) {
    std::error_code error;
    fs::rename(from, to, error);
    if (error) throw InputError(to.string(), "", "cannot be replaced: " + error.message());
  }
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

fs::path PathForImage(const fs::path& folder, const std::string& image_name, std::string_view suffix) {
  const fs::path relative(image_name);
  bool inside = !image_name.empty() && relative.is_relative() && relative.has_filename();
  for (const fs::path& part : relative) inside = inside && part != "..";
  if (!inside) throw InputError(image_name, "", "an image name must be a relative path that stays in its folder");
  fs::path path = folder / relative;
  path += std::string(suffix);
  if (!LiesInside(path.parent_path(), folder))
    throw InputError(path.string(), "", "a link in its folder leads out of it; expected it to stay inside");
  return path;
}

}  // namespace glint
