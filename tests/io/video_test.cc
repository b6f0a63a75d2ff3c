#include "io/video.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "core/error.h"
#include "tests/colmap/test_model.h"

namespace glint {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing_support::TemporaryFolder;
using testing_support::WriteFile;

TEST(ChooseFrames, TakesTheSharpestOfEachStep) {
  FrameTrack track;
  for (int i = 0; i <= 40; ++i) {
    track.path.push_back(0.01 * i);
    track.sharpness.push_back(i % 10 == 3 ? 2 : 1);
  }
  EXPECT_THAT(ChooseFrames(track, {.step_rel = 0.1, .max_frames = 100}), ElementsAre(3, 13, 23, 33, 35));
  EXPECT_THAT(ChooseFrames(track, {.step_rel = 0.001, .max_frames = 3}), SizeIs(3));
}

TEST(ChooseFrames, AtMostOneOfAViewThatStands) {
  EXPECT_THAT(ChooseFrames({std::vector<double>(50, 0.0), std::vector<double>(50, 1.0)}, {}), SizeIs(1));
  EXPECT_THAT(ChooseFrames({}, {}), IsEmpty());
}

// A window that moves over a wide random picture: 10 frames still, 40 frames 4 px each; every second one blurred.
void WriteFilm(const std::filesystem::path& path) {
  cv::Mat wide(240, 800, CV_8UC3), small(60, 200, CV_8UC3);
  cv::theRNG().state = 1;
  cv::randu(small, 0, 255);
  cv::resize(small, wide, wide.size(), 0, 0, cv::INTER_CUBIC);
  cv::VideoWriter film(path.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25, {320, 240});
  ASSERT_TRUE(film.isOpened());
  for (int i = 0; i < 50; ++i) {
    cv::Mat frame = wide(cv::Rect(4 * std::max(0, i - 10), 0, 320, 240)).clone();
    if (i % 2 == 1) cv::GaussianBlur(frame, frame, {}, 3);
    film.write(frame);
  }
}

TEST(Video, FramesAreSharpAndMove) {
  const TemporaryFolder folder;
  WriteFilm(folder / "film.avi");
  const FrameTrack track = TrackFrames(folder / "film.avi", Progress::Silent());
  ASSERT_EQ(track.path.size(), 50u);
  EXPECT_LT(track.path[9], 0.005) << "the view stands";
  EXPECT_NEAR(track.path[49], 4 * 39 / 400.0, 0.05);
  const std::vector<size_t> frames = ChooseFrames(track, {.step_rel = 0.04, .max_frames = 100});
  EXPECT_GE(frames.size(), 8u);
  for (const size_t frame : frames) EXPECT_EQ(frame % 2, 0u) << "frame " << frame << " is blurred";
  const auto names = WriteFrames(folder / "film.avi", frames, folder / "images", Progress::Silent());
  ASSERT_EQ(names.size(), frames.size());
  EXPECT_EQ(cv::imread(((folder / "images") / names.back()).string()).size(), cv::Size(320, 240));
}

TEST(Video, WhatIsNoFilmIsRefused) {
  const TemporaryFolder folder;
  WriteFilm(folder / "real.avi");
  const std::string real = (folder / "real.avi").string();
  // The last ones are lists of other files.
  const std::vector<std::string> texts = {"not a film", "#EXTM3U\n#EXTINF:2,\n" + real + "\n#EXT-X-ENDLIST\n",
                                          "ffconcat version 1.0\nfile real.avi\n"};
  for (const std::string& text : texts) {
    WriteFile(folder / "film.mp4", text);
    try {
      TrackFrames(folder / "film.mp4", Progress::Silent());
      ADD_FAILURE() << text;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("film.mp4"));
    }
  }
  // A pattern that OpenCV takes for a series of pictures.
  cv::imwrite((folder / "frame_01.png").string(), cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(90)));
  EXPECT_THROW(TrackFrames(folder / "frame_%02d.png", Progress::Silent()), InputError);
}

}  // namespace
}  // namespace glint
