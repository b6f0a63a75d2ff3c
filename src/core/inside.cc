#include "core/inside.h"

#include <algorithm>
#include <system_error>

namespace glint {

bool LiesInside(const std::filesystem::path& path, const std::filesystem::path& folder) {
  std::error_code error;
  const auto followed = std::filesystem::weakly_canonical(path, error);
  if (error) return false;
  const auto inside = std::filesystem::weakly_canonical(folder, error);
  if (error) return false;
  const auto [at_folder, at_path] = std::mismatch(inside.begin(), inside.end(), followed.begin(), followed.end());
  return at_folder == inside.end();
}

}  // namespace glint
