// Where the parts of a COLMAP project lie on the disk.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace glint {

struct ProjectPaths {
  std::filesystem::path root;
  std::filesystem::path model;   // folder with cameras.*, images.*, points3D.*
  std::filesystem::path images;  // folder that image names are relative to; empty: none found
  std::filesystem::path masks;   // folder with <image name>.png (COLMAP: 0 is masked out); empty: none found
  bool images_given = false;     // by the user: links in it may lead anywhere
  bool masks_given = false;
  std::vector<std::string> notes;  // choices made, for example which of several sub-models was taken
};

// Finds the parts of any usual layout: `sparse/0`, `sparse`, `dense/sparse`, the model folder itself; of several
// sub-models the one with the most registered images. `images` beside the model or as given, `masks` beside those;
// where the model itself was given, also in the folder above it, or above its `sparse`. Throws InputError when there is
// no model or a given folder is missing.
ProjectPaths FindProject(const std::filesystem::path& project, const std::filesystem::path& images_override = {},
                         const std::filesystem::path& masks_override = {});

// True if the folder is a COLMAP project in any of these layouts, sound or not.
bool IsProject(const std::filesystem::path& folder);

// How many images each model has that is a sub-folder of `folder`, in the order of their names.
std::vector<size_t> SubModelSizes(const std::filesystem::path& folder);

}  // namespace glint
