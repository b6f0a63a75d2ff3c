#include "pipeline/photo_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "colmap/photographs.h"
#include "colmap/project.h"
#include "colmap/step_record.h"
#include "core/error.h"
#include "core/parallel.h"
#include "io/project_images.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMinPhotographs = 3;  // fewer have no third view that could agree

// Sharp frames of a film, written once.
Photographs FramesOf(const fs::path& film, const fs::path& folder, const VideoOptions& options, Progress& progress) {
  Photographs frames;
  frames.folder = folder / "images";
  const StepRecord record(folder, "frames",
                          fmt::format("{}{} {}\n", FileStamp(film), options.step_rel, options.max_frames));
  if (!record.Done()) {
    record.MarkBegun();
    fs::remove_all(frames.folder);
    const FrameTrack track = TrackFrames(film, progress);
    const std::vector<size_t> chosen = ChooseFrames(track, options);
    if (chosen.size() < kMinPhotographs)
      throw InputError(film.string(), "",
                       fmt::format("the view moves by {:.1f} % of the frame's diagonal in {} frames; expected a film "
                                   "made while walking around the object",
                                   100 * track.path.back(), track.path.size()));
    WriteFrames(film, chosen, frames.folder, progress);
    progress.Info(fmt::format("{}: {} of {} frames taken", film.string(), chosen.size(), track.path.size()));
    record.MarkDone();
  }
  frames.names = FindPhotographs(frames.folder).names;
  frames.in_sequence = true;
  return frames;
}

// Leaves out what cannot be read as an image, and sees whether all have one size.
void LookAt(Photographs& photographs, Progress& progress) {
  const size_t n = photographs.names.size();
  std::vector<cv::Size> sizes(n);
  std::vector<std::string> damage(n);
  progress.Begin("look at photographs", n);
  ParallelFor(n, 1, [&](size_t i) {
    progress.ThrowIfCancelled();
    try {
      cv::Mat image;
      ReadImage(photographs.folder / photographs.names[i], image);
      sizes[i] = image.size();
    } catch (const InputError& e) {
      damage[i] = e.what();
    }
    progress.Advance();
  });
  std::vector<std::string> sound;
  cv::Size common;
  photographs.one_camera = true;
  for (size_t i = 0; i < n; ++i) {
    if (!damage[i].empty()) {
      progress.Warn("left out: " + damage[i]);
      continue;
    }
    if (sound.empty()) common = sizes[i];
    photographs.one_camera = photographs.one_camera && sizes[i] == common;
    sound.push_back(photographs.names[i]);
  }
  photographs.names = std::move(sound);
}

void ChooseCameras(Photographs& photographs, const std::string& cameras) {
  if (cameras == "one" && !photographs.one_camera)
    throw InputError(photographs.folder.string(), "photos.colmap.cameras = one",
                     "expected images of one size for one camera, found several sizes");
  if (cameras == "each") photographs.one_camera = false;
}

void Require(const Photographs& photographs, const fs::path& given) {
  std::string kinds;
  for (const std::string& kind : photographs.unreadable_kinds) kinds += (kinds.empty() ? "" : ", ") + kind;
  if (photographs.names.size() < kMinPhotographs)
    throw InputError(
        given.string(), "",
        fmt::format("expected a COLMAP project, a film, or at least {} photographs, found {}{}", kMinPhotographs,
                    photographs.names.size(), kinds.empty() ? "" : "; convert " + kinds + " files to JPEG or PNG"));
}

std::string WhyNot(const ReconstructSummary& summary, double min_registered, const fs::path& folder) {
  const auto registered = static_cast<double>(summary.num_registered());
  if (summary.num_registered() >= kMinPhotographs &&
      registered >= min_registered * static_cast<double>(summary.num_images))
    return "";
  std::string why = fmt::format("COLMAP registered only {} of {} images ({})", summary.num_registered(),
                                summary.num_images, (folder / "log.txt").string());
  for (const std::string& advice : summary.Advice()) why += "\n  - " + advice;
  return why;
}

}  // namespace

void PhotoOptions::Visit(OptionVisitor& v) {
  VisitSection(v, "colmap", "How the program colmap is run.", colmap);
  VisitSection(v, "video", "Which frames of a film are taken.", video);
  v.Field(
      {.name = "feature_masks",
       .help =
           "Folder of masks, <image name>.png: COLMAP takes no features where they are 0. The highlight_masks/ of an "
           "earlier run keep it off the highlights; masks of the object serve on a turntable."},
      feature_masks);
  v.Field({.name = "min_registered",
           .help = "Stop, and say what to do, when fewer images register.",
           .unit = "fraction of the images",
           .min = 0,
           .max = 1},
          min_registered);
}

PhotoStageResult RunPhotoStage(const fs::path& given, const fs::path& folder, const fs::path& out,
                               const PhotoOptions& options, Progress& progress) {
  PhotoStageResult result;
  result.project = given;
  if (!fs::exists(given) || IsProject(given)) return result;
  const bool is_film = !fs::is_directory(given);
  Photographs photographs = is_film ? FramesOf(given, folder, options.video, progress) : FindPhotographs(given, out);
  if (!is_film) LookAt(photographs, progress);
  if (is_film) photographs.one_camera = true;
  Require(photographs, given);
  ChooseCameras(photographs, options.colmap.cameras);
  photographs.feature_masks = options.feature_masks;
  if (!options.feature_masks.empty() && !fs::is_directory(options.feature_masks))
    throw InputError(options.feature_masks, "photos.feature_masks", "expected a folder of masks, found none");

  const ReconstructSummary summary = Reconstruct(photographs, folder, options.colmap, progress);
  result.project = folder;
  result.images = photographs.folder;
  result.masks = photographs.masks;
  result.steps = summary.steps;
  result.colmap_version = summary.version;
  result.report = summary.BriefReport();
  result.why_not = WhyNot(summary, options.min_registered, folder);
  if (result.why_not.empty() && 2 * summary.num_registered() < summary.num_images)
    progress.Warn(fmt::format("only {} of {} images registered; {}", summary.num_registered(), summary.num_images,
                              summary.Advice().front()));
  return result;
}

}  // namespace glint
