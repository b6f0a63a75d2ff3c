#include "colmap/photographs.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>

#include "core/error.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 10> kReadable = {".jpg", ".jpeg", ".png", ".tif", ".tiff",
                                                        ".bmp", ".ppm",  ".pgm", ".jp2", ".webp"};
constexpr std::array<std::string_view, 12> kUnreadable = {".heic", ".heif", ".avif", ".dng", ".cr2", ".cr3",
                                                          ".nef",  ".arw",  ".raf",  ".orf", ".rw2", ".raw"};
constexpr std::array<std::string_view, 5> kUsualFolders = {"images", "input", "photos", "imgs", "rgb"};

template <size_t N>
bool Among(const std::array<std::string_view, N>& list, std::string_view text) {
  return std::find(list.begin(), list.end(), text) != list.end();
}

std::string LowerExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// "img10" after "img9": runs of digits compare as numbers.
bool Before(std::string_view a, std::string_view b) {
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!IsDigit(a[i]) || !IsDigit(b[j])) {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i, ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    size_t m = i, n = j;
    while (m < a.size() && IsDigit(a[m])) ++m;
    while (n < b.size() && IsDigit(b[n])) ++n;
    const std::string_view x = a.substr(i, m - i), y = b.substr(j, n - j);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
    i = m, j = n;
  }
  if ((i < a.size()) != (j < b.size())) return j < b.size();
  return a < b;
}

// What comes before the last run of digits, and its number; nullopt without digits.
std::optional<std::pair<std::string, double>> Numbered(const std::string& name) {
  size_t end = name.size();
  while (end > 0 && !IsDigit(name[end - 1])) --end;
  size_t begin = end;
  while (begin > 0 && IsDigit(name[begin - 1])) --begin;
  if (begin == end) return std::nullopt;
  return std::pair(name.substr(0, begin), std::stod(name.substr(begin, end - begin)));
}

// What a run of ours left.
bool HoldsResults(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "stages", ignored) && fs::is_regular_file(folder / "log.txt", ignored);
}

bool LeftOut(const fs::path& folder, const fs::path& except) {
  const std::string name = folder.filename().string();
  std::error_code missing;
  return name.starts_with(".") || name == "masks" || name == "mask" || HoldsResults(folder) ||
         (!except.empty() && fs::equivalent(folder, except, missing));
}

void Collect(const fs::path& root, const fs::path& except, Photographs& found) {
  std::set<std::string> unreadable;
  std::error_code error;
  auto it = fs::recursive_directory_iterator(root, fs::directory_options::follow_directory_symlink, error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    std::error_code gone;
    if (it->is_directory(gone)) {
      if (LeftOut(it->path(), except)) it.disable_recursion_pending();
      continue;
    }
    const std::string extension = LowerExtension(it->path());
    if (it->path().filename().string().starts_with(".") || !it->is_regular_file(gone)) continue;
    if (Among(kReadable, extension))
      found.names.push_back(fs::relative(it->path(), root).generic_string());
    else if (Among(kUnreadable, extension))
      unreadable.insert(extension);
  }
  if (error) throw InputError(root.string(), "", "cannot be read: " + error.message());
  std::sort(found.names.begin(), found.names.end(), Before);
  found.unreadable_kinds.assign(unreadable.begin(), unreadable.end());
}

bool HoldsFiles(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && Among(kReadable, LowerExtension(entry.path()))) return true;
  return false;
}

}  // namespace

Photographs FindPhotographs(const fs::path& folder, const fs::path& except) {
  if (!fs::is_directory(folder)) throw InputError(folder.string(), "", "expected a folder of photographs");
  Photographs found;
  found.folder = folder;
  if (!HoldsFiles(folder)) {
    for (const std::string_view usual : kUsualFolders) {
      if (!fs::is_directory(folder / usual)) continue;
      found.folder = folder / usual;
      break;
    }
  }
  for (const fs::path& masks : {folder / "masks", folder / "mask"})
    if (fs::is_directory(masks)) found.masks = masks;
  Collect(found.folder, except, found);
  found.in_sequence = InSequence(found.names);
  return found;
}

bool InSequence(const std::vector<std::string>& names) {
  constexpr double kMostly = 0.9;
  constexpr double kLongestStep = 30;  // some were thrown away
  if (names.size() < 2) return false;
  size_t steps = 0;
  for (size_t i = 1; i < names.size(); ++i) {
    const auto before = Numbered(names[i - 1]), after = Numbered(names[i]);
    if (!before || !after || before->first != after->first) continue;
    steps += after->second > before->second && after->second - before->second <= kLongestStep;
  }
  return static_cast<double>(steps) >= kMostly * static_cast<double>(names.size() - 1);
}

}  // namespace glint
