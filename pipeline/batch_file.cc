#include "pipeline/batch_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <array>
#include <fstream>
#include <map>
#include <sstream>
#include <string_view>

#include "core/error.h"
#include "pipeline/config_file.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 10> kProjectKeys = {"project", "name",   "out",   "config",  "lights",
                                                           "mesh",    "images", "masks", "normals", "set"};

class BatchReader {
 public:
  explicit BatchReader(const fs::path& file) : file_(file) {}

  std::vector<BatchProject> Read(const YAML::Node& root) {
    BatchProject common;
    YAML::Node list;
    for (const auto& pair : root) {
      const std::string key = pair.first.IsScalar() ? pair.first.Scalar() : "";
      if (key == "projects")
        list = pair.second;
      else if (key == "project" || key == "name" || !Set(common, key, pair.second))
        Problem(pair.first,
                fmt::format("unknown key \"{}\"; known here: out, config, lights, mesh, images, masks, normals, set, "
                            "projects",
                            key));
    }
    if (!list.IsSequence() || list.size() == 0)
      throw InputError(file_.string(), "projects", "expected a list with at least one project");
    std::vector<BatchProject> projects;
    for (const YAML::Node& node : list) projects.push_back(ReadProject(node, common));
    problems_.ThrowIfAny();
    return projects;
  }

 private:
  BatchProject ReadProject(const YAML::Node& node, const BatchProject& common) {
    BatchProject project = common;
    project.out.clear();
    if (node.IsScalar()) {
      project.project = Path(node.Scalar());
    } else if (node.IsMap()) {
      for (const auto& pair : node) {
        const std::string key = pair.first.IsScalar() ? pair.first.Scalar() : "";
        if (!Set(project, key, pair.second))
          Problem(pair.first, fmt::format("unknown key \"{}\"; known here: {}", key, fmt::join(kProjectKeys, ", ")));
      }
    }
    if (project.project.empty()) Problem(node, "expected a project: its folder");
    if (project.name.empty()) project.name = FolderName(project.project);
    if (project.name.empty()) Problem(node, "expected a name: this folder has none");
    if (project.out.empty()) project.out = (common.out.empty() ? Path("glint") : common.out) / project.name;
    const auto [other, is_new] = by_out_.emplace(project.out.lexically_normal().string(), project.name);
    if (!is_new)
      Problem(node, fmt::format("{} and {} would both write into {}; give one of them a name", project.name,
                                other->second, project.out.string()));
    return project;
  }

  // False: no such key.
  bool Set(BatchProject& project, const std::string& key, const YAML::Node& value) {
    const std::map<std::string_view, fs::path*> paths = {{"project", &project.project}, {"out", &project.out},
                                                         {"config", &project.config},   {"lights", &project.lights},
                                                         {"mesh", &project.mesh},       {"images", &project.images},
                                                         {"masks", &project.masks},     {"normals", &project.normals}};
    if (const auto path = paths.find(key); path != paths.end()) {
      if (!value.IsScalar()) Problem(value, fmt::format("{}: expected a path", key));
      *path->second = Path(value.IsScalar() ? value.Scalar() : "");
    } else if (key == "name") {
      SetName(project, value);
    } else if (key == "set") {
      AddSettings(project, value);
    } else {
      return false;
    }
    return true;
  }

  void SetName(BatchProject& project, const YAML::Node& value) {
    project.name = value.IsScalar() ? value.Scalar() : "";
    if (project.name.empty() || project.name.find('/') != std::string::npos || project.name.starts_with('.'))
      Problem(value, "name: expected a name for a folder");
  }

  void AddSettings(BatchProject& project, const YAML::Node& value) {
    if (!value.IsMap()) return Problem(value, "set: expected options and values, like {refine.voxel_rel: 0.005}");
    for (const auto& pair : value) {
      if (!pair.first.IsScalar() || !pair.second.IsScalar())
        Problem(pair.first, "set: expected an option's whole name and its value");
      else
        project.settings.push_back(pair.first.Scalar() + "=" + pair.second.Scalar());
    }
  }

  fs::path Path(const std::string& text) const {
    return text.empty() ? fs::path() : (file_.parent_path() / text).lexically_normal();
  }
  static std::string FolderName(const fs::path& folder) {
    if (folder.empty()) return "";
    const fs::path path = fs::absolute(folder).lexically_normal();  // "." and ".." have names, too
    return path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
  }
  void Problem(const YAML::Node& node, const std::string& what) {
    problems_.messages.push_back(fmt::format("{}:{}: {}", file_.string(), node.Mark().line + 1, what));
  }

  const fs::path& file_;
  ConfigProblems problems_;
  std::map<std::string, std::string> by_out_;  // output folder -> name
};

}  // namespace

std::vector<BatchProject> ReadBatchFile(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  if (!fs::is_regular_file(file) || !in || !(text << in.rdbuf()))
    throw InputError(file.string(), "", "cannot be read; expected a YAML file with a list of projects");
  try {
    const YAML::Node root = YAML::Load(text.str());
    if (!root.IsMap()) throw InputError(file.string(), "", "expected a list \"projects\"");
    return BatchReader(file).Read(root);
  } catch (const YAML::Exception& e) {
    throw InputError(fmt::format("{}:{}", file.string(), e.mark.line + 1), "", "not valid YAML: " + e.msg);
  }
}

}  // namespace glint
