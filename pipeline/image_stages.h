// The work that goes image by image: each is read, used and let go, a few at a time.
#pragma once

#include <filesystem>
#include <vector>

#include "colmap/scene.h"
#include "core/progress.h"
#include "highlights/detect.h"
#include "highlights/highlight.h"
#include "io/image_source.h"

namespace glint {

// Candidates of every view, by view and within it as DetectHighlights() sorts them. Views without an image have none.
std::vector<Highlight> DetectInAllViews(const Scene& scene, const ImageSource& images, const DetectOptions& options,
                                        Progress& progress);

// `folder/<image name>.png` for every view: the image, at most `max_side_px` large, with its highlights drawn.
void WriteOverlays(const Scene& scene, const ImageSource& images, const std::vector<Highlight>& highlights,
                   int max_side_px, const std::filesystem::path& folder, Progress& progress);

// `folder/<image name>.png` for every view, as COLMAP names and reads masks: 0 where a highlight is.
void WriteHighlightMasks(const Scene& scene, const std::vector<Highlight>& highlights,
                         const std::filesystem::path& folder, Progress& progress);

}  // namespace glint
