// What a project, a mesh or a VDB file is, and whether it is fit for use: the words of `glint inspect`.
#pragma once

#include <filesystem>
#include <string>

#include "core/progress.h"

namespace glint {

struct Inspection {
  std::string text;  // lines for people
  bool fit = false;  // nothing stands in the way of using it
};

struct InspectArguments {
  std::filesystem::path path;
  std::filesystem::path images;  // of a project; empty: found
  std::filesystem::path masks;
  bool read_images = true;  // of a project: decode every image
};

// A folder is a project, a .vdb file a field, any other file a mesh. Throws InputError for what cannot be read at all.
Inspection Inspect(const InspectArguments& arguments, Progress& progress);

}  // namespace glint
