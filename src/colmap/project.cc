#include "colmap/project.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <system_error>

#include "colmap/model_files.h"
#include "core/error.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

bool IsFolder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

bool IsFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

// Without ".", ".." and a slash at the end; links stay links, for people sort their files with them.
fs::path AbsolutePath(const fs::path& path) {
  const fs::path normal = fs::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

// Any of a model's main files: an incomplete model is found, too, and reading it says what is missing.
bool IsModel(const fs::path& folder) {
  constexpr std::array kFiles = {"images.bin", "images.txt", "cameras.bin", "cameras.txt"};
  return std::any_of(kFiles.begin(), kFiles.end(), [&](const char* file) { return IsFile(folder / file); });
}

// The names of a model's images; empty where they cannot be read (reading the model will say why).
std::vector<std::string> ImageNames(const fs::path& model) {
  try {
    if (IsFile(model / "images.bin")) return internal::ReadImageNamesBinary(model / "images.bin");
    if (IsFile(model / "images.txt")) return internal::ReadImageNamesText(model / "images.txt");
  } catch (const InputError&) {
  }
  return {};
}

// Sub-folders that hold models, in the order of their names ("2" before "10").
std::vector<fs::path> SubModels(const fs::path& folder) {
  std::vector<fs::path> models;
  if (!IsFolder(folder)) return models;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() && IsModel(entry.path())) models.push_back(entry.path());
  }
  std::sort(models.begin(), models.end(), [](const fs::path& a, const fs::path& b) {
    const std::string x = a.filename().string();
    const std::string y = b.filename().string();
    return x.size() != y.size() ? x.size() < y.size() : x < y;
  });
  return models;
}

std::vector<fs::path> FindModels(const fs::path& project) {
  if (IsModel(project)) return {project};
  for (const char* where : {"sparse", "dense/sparse", "colmap/sparse", "dense/0/sparse", "distorted/sparse", "."}) {
    const fs::path folder = (project / where).lexically_normal();
    if (IsModel(folder)) return {folder};
    if (auto models = SubModels(folder); !models.empty()) return models;
  }
  return {};
}

fs::path LargestModel(const std::vector<fs::path>& models, std::vector<std::string>& notes) {
  if (models.size() == 1) return models.front();
  size_t best = 0;
  std::vector<size_t> sizes;
  std::string list;
  for (const fs::path& model : models) {
    sizes.push_back(ImageNames(model).size());
    if (sizes.back() > sizes[best]) best = sizes.size() - 1;
    list += fmt::format("{}{} ({} images)", list.empty() ? "" : ", ", model.filename().string(), sizes.back());
  }
  notes.push_back(fmt::format("{} sub-models: {}; took {}, which has the most images", models.size(), list,
                              models[best].filename().string()));
  return models[best];
}

// Up to `limit` names spread over the list.
std::vector<std::string> Sample(const std::vector<std::string>& names, size_t limit) {
  if (names.size() <= limit) return names;
  std::vector<std::string> sample;
  for (size_t i = 0; i < limit; ++i) sample.push_back(names[i * names.size() / limit]);
  return sample;
}

// Of the folders `candidates` beside the model and its parents, down from the nearest: the one that holds most of
// the names; where none holds any, the first that exists.
struct Parents {
  std::vector<fs::path> folders;
  size_t num_inside = 0;  // the first ones lie inside the project
};
struct FolderChoice {
  fs::path folder;
  fs::path parent;  // of the folders to search, the one that it is in
  size_t num_found = 0;
};
FolderChoice ChooseFolder(const Parents& parents, const std::vector<const char*>& candidates,
                          const std::vector<std::string>& names, const std::string& suffix) {
  FolderChoice choice;
  for (size_t i = 0; i < parents.folders.size(); ++i) {
    const fs::path& parent = parents.folders[i];
    for (const char* candidate : candidates) {
      const fs::path folder = *candidate ? parent / candidate : parent;
      if (!IsFolder(folder)) continue;
      const auto found = static_cast<size_t>(std::count_if(
          names.begin(), names.end(), [&](const auto& name) { return IsFile(folder / (name + suffix)); }));
      // Folders above the project and the parent itself, candidate "", count only if the files are there.
      const bool is_first = choice.folder.empty() && *candidate && i < parents.num_inside;
      if (is_first || found > choice.num_found) choice = {folder, parent, found};
    }
  }
  return choice;
}

// The folder that a project's parts lie in. It is above the one that was given where that is the model: "p" for
// "p/sparse/0", "p/sparse" and "p/0".
fs::path TopFolder(const fs::path& root, const fs::path& model) {
  fs::path top = root;
  if (top == model && top.filename() != "sparse") top = top.parent_path();
  if (top.filename() == "sparse") top = top.parent_path();
  return top;
}

// The model's folder and the folders above it up to the one that the project's parts lie in. What is farther up belongs
// to others: many objects have an IMG_0001.JPG.
Parents ParentsToSearch(const fs::path& project, const fs::path& model) {
  Parents parents;
  const fs::path root = AbsolutePath(project), top = TopFolder(root, AbsolutePath(model));
  for (fs::path folder = AbsolutePath(model);; folder = folder.parent_path()) {
    parents.folders.push_back(folder);
    if (folder == root) parents.num_inside = parents.folders.size();
    if (folder == top || folder == folder.parent_path()) break;
  }
  return parents;
}

// Masks are beside the images, or nearer to the model.
Parents ParentsOfMasks(const Parents& parents, const fs::path& beside_images) {
  Parents result = parents;
  const auto found = std::find(result.folders.begin(), result.folders.end(), beside_images);
  if (found != result.folders.end()) result.folders.erase(found + 1, result.folders.end());
  result.folders.insert(result.folders.begin(), beside_images);
  ++result.num_inside;
  return result;
}

}  // namespace

ProjectPaths FindProject(const fs::path& project, const fs::path& images_override, const fs::path& masks_override) {
  if (!IsFolder(project)) {
    throw InputError(
        project.string(), "",
        fs::exists(project) ? "expected a project folder, found a file" : "expected a project folder, found nothing");
  }
  for (const fs::path& given : {images_override, masks_override}) {
    if (!given.empty() && !IsFolder(given)) throw InputError(given.string(), "", "expected a folder, found none");
  }
  ProjectPaths paths;
  // "sparse/" and "sparse" are the same folder, but only the second has a file name.
  paths.root = project.has_filename() || !project.has_parent_path() ? project : project.parent_path();
  const auto models = FindModels(paths.root);
  if (models.empty()) {
    throw InputError(project.string(), "",
                     "expected a COLMAP model (cameras, images and points3D as .bin or .txt) in it or in sparse/0, "
                     "sparse or dense/sparse, found none");
  }
  paths.model = LargestModel(models, paths.notes);

  const auto names = Sample(ImageNames(paths.model), 50);
  const auto parents = ParentsToSearch(paths.root, paths.model);
  paths.images = images_override;
  paths.images_given = !images_override.empty();
  fs::path beside_images;
  if (paths.images_given) {
    beside_images = AbsolutePath(paths.images).parent_path();
  } else {
    const std::vector<const char*> usual_names = {"images", "input", "imgs", "image", "photos", "rgb", ""};
    const FolderChoice choice = ChooseFolder(parents, usual_names, names, "");
    paths.images = choice.folder;
    beside_images = choice.parent;
    if (paths.images.empty()) paths.notes.push_back("no folder with the model's images was found");
  }
  paths.masks = masks_override;
  paths.masks_given = !masks_override.empty();
  if (paths.masks.empty()) {
    const Parents mask_parents = paths.images.empty() ? parents : ParentsOfMasks(parents, beside_images);
    const FolderChoice choice = ChooseFolder(mask_parents, {"masks", "mask"}, names, ".png");
    if (choice.num_found > 0) {
      paths.masks = choice.folder;
    } else if (!choice.folder.empty()) {
      paths.notes.push_back(fmt::format("{}: not used as masks: no file is called <image name>.png, for example {}.png",
                                        choice.folder.string(), names.empty() ? "image.jpg" : names.front()));
    }
  }
  return paths;
}

bool IsProject(const fs::path& folder) { return IsFolder(folder) && !FindModels(folder).empty(); }

std::vector<size_t> SubModelSizes(const fs::path& folder) {
  std::vector<size_t> sizes;
  for (const fs::path& model : SubModels(folder)) sizes.push_back(ImageNames(model).size());
  return sizes;
}

}  // namespace glint
