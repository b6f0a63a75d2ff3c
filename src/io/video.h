// Frames of a film that are worth to be photographs: sharp ones, between which the view has moved.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/options.h"
#include "core/progress.h"

namespace glint {

struct VideoOptions {
  double step_rel = 0.03;
  int max_frames = 120;

  void Visit(OptionVisitor& v);
};

// What is known of each frame in turn, once the film has been looked at.
struct FrameTrack {
  std::vector<double> path;       // how far the view has moved up to it, fraction of the frame's diagonal
  std::vector<double> sharpness;  // larger is sharper; comparable between neighbours
};

// The frames to take, ascending: the sharpest near each of equal steps along the path; steps of `step_rel`, longer
// where there would be more than `max_frames`.
std::vector<size_t> ChooseFrames(const FrameTrack& track, const VideoOptions& options);

// Looks at every frame. Throws InputError: not a film that can be read, no frames.
FrameTrack TrackFrames(const std::filesystem::path& film, Progress& progress);

// Writes frames (ascending) as FOLDER/frame_000123.jpg and returns their names.
std::vector<std::string> WriteFrames(const std::filesystem::path& film, const std::vector<size_t>& frames,
                                     const std::filesystem::path& folder, Progress& progress);

}  // namespace glint
