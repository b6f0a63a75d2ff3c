// The output folder of a run: one run at a time, and nothing half-written under a final name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
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
  std::filesystem::path MeshAs(const char* extension) const { return Mesh().replace_extension(extension); }
  std::filesystem::path LevelSetFile() const { return root_ / "sdf.vdb"; }
  std::filesystem::path Seed() const { return root_ / "seed.ply"; }
  std::filesystem::path Lights() const { return root_ / "lights.json"; }
  std::filesystem::path Overlays() const { return root_ / "highlights"; }
  std::filesystem::path HighlightMasks() const { return root_ / "highlight_masks"; }
  std::filesystem::path Config() const { return root_ / "config.yaml"; }
  std::filesystem::path Report() const { return root_ / "report.json"; }
  std::filesystem::path ReportPage() const { return root_ / "report.html"; }
  std::filesystem::path Log() const { return root_ / "log.txt"; }
  // The COLMAP project of a run that begins with photographs.
  std::filesystem::path Photographs() const { return root_ / "colmap"; }
  // What the stages leave for those after them, and for a run that goes on.
  std::filesystem::path Stages() const { return root_ / "stages"; }
  std::filesystem::path Start() const { return Stages() / "start.ply"; }
  std::filesystem::path Points() const { return Stages() / "points.ply"; }
  std::filesystem::path PointsOnObject() const { return Stages() / "points_on_object.txt"; }
  std::filesystem::path Outline() const { return Stages() / "outline.txt"; }
  std::filesystem::path Candidates() const { return Stages() / "candidates.json"; }
  std::filesystem::path StageLights() const { return Stages() / "lights.json"; }
  std::filesystem::path Gated() const { return Stages() / "highlights.json"; }
  std::filesystem::path Refined() const { return Stages() / "refined_highlights.json"; }
  std::filesystem::path Contacts() const { return Stages() / "contacts.json"; }

  std::filesystem::path StagedFiles() const { return Stages() / "new"; }

  const std::filesystem::path& root() const { return root_; }

  // When a run ends without a mesh: moves mesh, field, lights, configuration and report of an earlier finished run into
  // `earlier/`, so that what lies in the folder belongs together and nothing is lost; but not what is an input of this
  // run. Returns whether there were any.
  bool SetEarlierResultsAside(const std::vector<std::filesystem::path>& inputs) const;

 private:
  std::filesystem::path root_;
  int folder_ = -1;  // file descriptor that carries the lock
};

// Several files that take the place of those of an earlier run all together, once every one is written.
class Publication {
 public:
  explicit Publication(const Workspace& out);
  // Where to write what will become `file`.
  std::filesystem::path For(const std::filesystem::path& file);
  // `file` is of the earlier run alone and goes.
  void Remove(const std::filesystem::path& file) { gone_.push_back(file); }
  // Throws InputError if the system refuses.
  void Publish();

 private:
  std::filesystem::path folder_;
  std::vector<std::pair<std::filesystem::path, std::filesystem::path>> files_;  // from, to
  std::vector<std::filesystem::path> gone_;
};

// Where an image called `image_name` in the model goes below `folder`: `folder/image_name + suffix`. Names that would
// leave the folder (absolute, with "..", through a link) are refused with InputError.
std::filesystem::path PathForImage(const std::filesystem::path& folder, const std::string& image_name,
                                   std::string_view suffix);

}  // namespace glint
