// The output folder of a run: one run at a time, and nothing half-written under a final name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

// Creates the folder if need be and holds a lock on it while it lives. The lock is the operating system's and sits on
// the folder itself, so a killed run leaves none behind. Temporary files of a killed run are removed.
// Throws InputError when the folder cannot be made or written, or another run holds it.
class Workspace {
 public:
  explicit Workspace(std::filesystem::path root);
  ~Workspace();
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  // What a user looks for.
  std::filesystem::path Mesh() const { return root_ / "mesh.ply"; }
  std::filesystem::path LevelSetFile() const { return root_ / "sdf.vdb"; }
  std::filesystem::path Seed() const { return root_ / "seed.ply"; }
  std::filesystem::path Lights() const { return root_ / "lights.json"; }
  std::filesystem::path Overlays() const { return root_ / "highlights"; }
  std::filesystem::path Config() const { return root_ / "config.yaml"; }
  std::filesystem::path Report() const { return root_ / "report.json"; }
  std::filesystem::path ReportPage() const { return root_ / "report.html"; }
  std::filesystem::path Log() const { return root_ / "log.txt"; }
  // What a later run with --from needs of the stages before.
  std::filesystem::path Stages() const { return root_ / "stages"; }
  std::filesystem::path Start() const { return Stages() / "start.ply"; }

  const std::filesystem::path& root() const { return root_; }

  // Removes the results of an earlier run that this run will write anew, so that a run that fails leaves no
  // results that are not its own; but not those that are inputs of this run.
  void RemoveResults(const std::vector<std::filesystem::path>& inputs) const;

 private:
  std::filesystem::path root_;
  int folder_ = -1;  // file descriptor that carries the lock
};

// Where an image called `image_name` in the model goes below `folder`: `folder/image_name + suffix`. Names that would
// leave the folder (absolute, or with "..") are refused with InputError.
std::filesystem::path PathForImage(const std::filesystem::path& folder, const std::string& image_name,
                                   std::string_view suffix);

}  // namespace glint
