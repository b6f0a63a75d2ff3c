#include "io/video.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <opencv2/videoio.hpp>
#include <system_error>

#include "core/check.h"
#include "core/error.h"
#include "core/median.h"
#include "io/project_images.h"

namespace glint {
namespace {

constexpr int kTrackedSide = 480;  // px, of the frames that motion is measured in
constexpr int kMaxCorners = 300;
constexpr double kNewAnchorRel = 0.02;  // of the diagonal: how far points are followed before new ones are taken
constexpr double kMinFollowed = 0.6;    // of the points
constexpr double kWindow = 0.5;         // of a step to either side, in which the sharpest frame is taken
constexpr double kMaxLost = 0.02;       // of the frames that the film's header promises

// A list of other files, which FFmpeg would open: HLS, its own, DASH.
bool IsPlaylist(const std::filesystem::path& file) {
  std::string head(16, '\0');
  std::ifstream(file, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.starts_with("#EXTM3U") || head.starts_with("ffconcat") || head.starts_with("<");
}

// By FFmpeg alone: for what that cannot read OpenCV would look at cameras on the USB, and take names for patterns of
// other names or for GStreamer's pipelines. An absolute name is no address of anything else.
cv::VideoCapture Open(const std::filesystem::path& film) {
  cv::VideoCapture capture;
  std::error_code ignored;
  if (std::filesystem::is_regular_file(film, ignored) && !IsPlaylist(film))
    capture.open(std::filesystem::absolute(film).string(), cv::CAP_FFMPEG);
  if (!capture.isOpened())
    throw InputError(film.string(), "",
                     "expected a film (or a folder of photographs, or a COLMAP project); it cannot "
                     "be read as one");
  return capture;
}

cv::Mat SmallGrey(const cv::Mat& frame) {
  cv::Mat grey, small;
  if (frame.channels() == 1) {
    grey = frame;
  } else {
    cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
  }
  const double scale = std::min(1.0, static_cast<double>(kTrackedSide) / std::max(frame.cols, frame.rows));
  cv::resize(grey, small, cv::Size(), scale, scale, cv::INTER_AREA);
  return small;
}

// Energy of the second derivatives against that of the grey values: blur takes it away, darkness does not.
double Sharpness(const cv::Mat& grey) {
  cv::Mat laplacian;
  cv::Laplacian(grey, laplacian, CV_32F);
  cv::Scalar mean, deviation, unused, of_grey;
  cv::meanStdDev(laplacian, mean, deviation);
  cv::meanStdDev(grey, unused, of_grey);
  return deviation[0] / std::max(of_grey[0], 1.0);
}

// How far the view moves: corners are followed from an anchor frame on until they are far, which then counts; to and
// fro within that distance, as a hand shakes, does not add up.
class PathMeter {
 public:
  double Add(const cv::Mat& grey) {
    if (anchor_.empty()) return SetAnchor(grey), path_;
    const double moved = Moved(grey);
    if (moved < 0) {  // lost them: a cut, or too fast
      path_ += kNewAnchorRel;
      return SetAnchor(grey), path_;
    }
    const double here = path_ + moved;
    if (moved >= kNewAnchorRel || followed_ < kMinFollowed) {
      path_ = here;
      SetAnchor(grey);
    }
    return here;
  }

 private:
  void SetAnchor(const cv::Mat& grey) {
    anchor_ = grey;
    points_.clear();
    cv::goodFeaturesToTrack(grey, points_, kMaxCorners, 0.01, 8);
  }

  // Median motion of the corners, fraction of the diagonal; negative: too few could be followed.
  double Moved(const cv::Mat& grey) {
    constexpr size_t kMinPoints = 8;
    if (points_.size() < kMinPoints) return -1;
    std::vector<cv::Point2f> now;
    std::vector<uchar> found;
    std::vector<float> error;
    cv::calcOpticalFlowPyrLK(anchor_, grey, points_, now, found, error);
    std::vector<double> motion;
    for (size_t i = 0; i < now.size(); ++i)
      if (found[i]) motion.push_back(cv::norm(now[i] - points_[i]));
    followed_ = static_cast<double>(motion.size()) / static_cast<double>(points_.size());
    if (motion.size() < kMinPoints) return -1;
    return Median(motion) / std::hypot(grey.cols, grey.rows);
  }

  cv::Mat anchor_;
  std::vector<cv::Point2f> points_;
  double path_ = 0, followed_ = 1;
};

}  // namespace

void VideoOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "step_rel",
           .help = "How far the view moves from one frame that is taken to the next.",
           .unit = "fraction of the frame's diagonal",
           .min = 0.001,
           .max = 1},
          step_rel);
  v.Field({.name = "max_frames", .help = "At most so many frames are taken; the steps grow.", .min = 3, .max = 100000},
          max_frames);
}

std::vector<size_t> ChooseFrames(const FrameTrack& track, const VideoOptions& options) {
  GLINT_CHECK_EQ(track.path.size(), track.sharpness.size());
  std::vector<size_t> chosen;
  if (track.path.empty()) return chosen;
  const double length = track.path.back();
  const auto count = static_cast<size_t>(
      std::clamp(std::floor(length / options.step_rel) + 1, 1.0, static_cast<double>(options.max_frames)));
  const double step = count > 1 ? length / static_cast<double>(count - 1) : 0;
  size_t first = 0;
  for (size_t k = 0; k < count; ++k) {
    // Half a step to either side; the path ascends, or nearly so where a hand shakes.
    const double until = (static_cast<double>(k) + kWindow) * step;
    size_t best = track.path.size();
    for (; first < track.path.size() && (track.path[first] < until || k + 1 == count); ++first)
      if (best == track.path.size() || track.sharpness[first] > track.sharpness[best]) best = first;
    if (best < track.path.size()) chosen.push_back(best);
  }
  return chosen;
}

FrameTrack TrackFrames(const std::filesystem::path& film, Progress& progress) {
  cv::VideoCapture capture = Open(film);
  const double promised = std::max(0.0, capture.get(cv::CAP_PROP_FRAME_COUNT));
  progress.Begin("look at frames", static_cast<size_t>(promised));
  FrameTrack track;
  PathMeter meter;
  cv::Mat frame;
  while (capture.read(frame)) {
    progress.ThrowIfCancelled();
    const cv::Mat grey = SmallGrey(frame);
    track.path.push_back(meter.Add(grey));
    track.sharpness.push_back(Sharpness(grey));
    progress.Advance();
  }
  if (track.path.empty()) throw InputError(film.string(), "", "expected a film, found no frame in it");
  const auto read = static_cast<double>(track.path.size());
  if (read < (1 - kMaxLost) * promised)
    progress.Warn(
        fmt::format("{}: only {} of {:.0f} frames can be read; is the file whole?", film.string(), read, promised));
  return track;
}

std::vector<std::string> WriteFrames(const std::filesystem::path& film, const std::vector<size_t>& frames,
                                     const std::filesystem::path& folder, Progress& progress) {
  constexpr int kQuality = 97;
  cv::VideoCapture capture = Open(film);
  progress.Begin("write frames", frames.size());
  std::vector<std::string> names;
  size_t next = 0;
  cv::Mat frame;
  for (size_t index = 0; next < frames.size() && capture.grab(); ++index) {
    progress.ThrowIfCancelled();
    if (index != frames[next]) continue;
    if (!capture.retrieve(frame)) throw InputError(film.string(), fmt::format("frame {}", index), "cannot be read");
    names.push_back(fmt::format("frame_{:06}.jpg", index));
    WriteImageJpeg(folder / names.back(), frame, kQuality);
    progress.Advance();
    ++next;
  }
  return names;
}

}  // namespace glint
