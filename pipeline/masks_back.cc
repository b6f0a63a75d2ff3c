#include "pipeline/masks_back.h"

#include "colmap/project.h"
#include "core/error.h"
#include "pipeline/workspace.h"

namespace glint {

namespace fs = std::filesystem;

fs::path KeepMasksForFeatures(const fs::path& project, const fs::path& out, bool anew) {
  if (IsProject(project))
    throw InputError(project.string(), "--masks-back",
                     "is a COLMAP project, on which COLMAP is not run; expected the photographs or a film");
  const Workspace workspace(out);
  const fs::path found = workspace.HighlightMasks();
  fs::path kept = workspace.root() / "feature_masks";
  const bool there = fs::is_directory(kept);
  if (there && (!anew || !fs::is_directory(found))) return kept;
  if (!fs::is_directory(found))
    throw InputError(found.string(), "--masks-back",
                     "expected the masks of an earlier run there, found none; run first without --masks-back");
  const fs::path copy = workspace.root() / "feature_masks.new";
  fs::remove_all(copy);
  fs::copy(found, copy, fs::copy_options::recursive);
  fs::remove_all(kept);
  fs::rename(copy, kept);
  return kept;
}

}  // namespace glint
