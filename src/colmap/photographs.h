// The photographs in a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace glint {

struct Photographs {
  std::filesystem::path folder;
  std::vector<std::string> names;             // relative to it, '/' separated, sorted as people count (2 before 10)
  std::filesystem::path masks;                // a folder called so beside the photographs; empty: none
  std::filesystem::path feature_masks;        // with <name>.png: no features where it is 0; empty: none
  bool in_sequence = false;                   // shot one after the other in the order of the names, as a film's frames
  bool one_camera = false;                    // taken with one camera at one focal length
  std::vector<std::string> unreadable_kinds;  // extensions of pictures that COLMAP does not read (".heic")
};

// The images below `folder`, or in its sub-folder "images" (or another of the usual names) if there is none beside it;
// but not those in hidden folders, in folders of masks or of results, or below `except`. Their bytes are not looked at.
Photographs FindPhotographs(const std::filesystem::path& folder, const std::filesystem::path& except = {});

// True if the names count up, as a camera's files do in the order of shooting.
bool InSequence(const std::vector<std::string>& names);

}  // namespace glint
