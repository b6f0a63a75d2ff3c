#include "io/project_images.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "tests/colmap/test_model.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ReadText;
using testing_support::TemporaryFolder;
using testing_support::WriteFile;

constexpr int kWidth = 12, kHeight = 8;

// A smooth colour gradient.
cv::Mat Gradient(int width = kWidth, int height = kHeight) {
  cv::Mat image(height, width, CV_8UC3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      image.at<cv::Vec3b>(y, x) = {static_cast<uchar>(10 * x), static_cast<uchar>(20 * y), 90};
  }
  return image;
}

Scene SceneOf(const std::vector<std::string>& names, int width = kWidth, int height = kHeight) {
  Scene scene;
  for (const std::string& name : names) {
    View& view = scene.views.emplace_back();
    view.name = name;
    view.camera = {
        1, CameraModel::kPinhole, static_cast<uint64_t>(width), static_cast<uint64_t>(height), {10, 10, 6, 4}};
  }
  return scene;
}

ProjectPaths PathsOf(const TemporaryFolder& folder) {
  ProjectPaths paths;
  paths.root = folder.path();
  paths.images = folder / "images";
  paths.masks = folder / "masks";
  return paths;
}

void Save(const fs::path& path, const cv::Mat& image, const std::vector<int>& options = {}) {
  fs::create_directories(path.parent_path());
  ASSERT_TRUE(cv::imwrite(path.string(), image, options));
}

class Warnings : public Progress {
 public:
  void Warn(std::string_view message) override { messages.emplace_back(message); }
  std::vector<std::string> messages;
};

// Loads the only image of a project, of the given bytes or pixels.
struct OneImage {
  TemporaryFolder folder;
  std::string error;
  cv::Mat image;
  void Load(const std::string& name, int width = kWidth, int height = kHeight) {
    try {
      const ProjectImages images(SceneOf({name}, width, height), PathsOf(folder));
      EXPECT_TRUE(images.Load(0, image));
    } catch (const InputError& e) {
      error = e.what();
      EXPECT_EQ(e.path(), (folder / ("images/" + name)).string());
    }
  }
};

TEST(ProjectImages, EightAndSixteenBitGreyAndColorBecomeBgr) {
  const cv::Mat color = Gradient();
  cv::Mat color16, grey, grey16, alpha;
  color.convertTo(color16, CV_16U, 257);
  cv::cvtColor(color, grey, cv::COLOR_BGR2GRAY);
  grey.convertTo(grey16, CV_16U, 257);
  cv::cvtColor(color, alpha, cv::COLOR_BGR2BGRA);
  const std::vector<std::pair<cv::Mat, int>> cases = {
      {color, CV_8UC3}, {color16, CV_16UC3}, {grey, CV_8UC3}, {grey16, CV_16UC3}, {alpha, CV_8UC3}};
  for (const auto& [saved, type] : cases) {
    OneImage one;
    Save(one.folder / "images/sub folder/ünï.png", saved);
    one.Load("sub folder/ünï.png");
    ASSERT_EQ(one.error, "");
    EXPECT_EQ(one.image.type(), type);
    cv::Mat expected = saved;
    if (saved.channels() == 1) cv::cvtColor(saved, expected, cv::COLOR_GRAY2BGR);
    if (saved.channels() == 4) expected = color;
    EXPECT_EQ(cv::norm(one.image, expected, cv::NORM_INF), 0);
  }
}

TEST(ProjectImages, CmykJpeg) {
  // 8 x 8 pixels without cyan and black, half magenta, full yellow: orange.
  const unsigned char bytes[] = {
      0xff, 0xd8, 0xff, 0xee, 0x00, 0x0e, 0x41, 0x64, 0x6f, 0x62, 0x65, 0x00, 0x64, 0x00, 0x00, 0x00, 0x00, 0x00,
      0xff, 0xdb, 0x00, 0x43, 0x00, 0x02, 0x01, 0x01, 0x01, 0x01, 0x01, 0x02, 0x01, 0x01, 0x01, 0x02, 0x02, 0x02,
      0x02, 0x02, 0x04, 0x03, 0x02, 0x02, 0x02, 0x02, 0x05, 0x04, 0x04, 0x03, 0x04, 0x06, 0x05, 0x06, 0x06, 0x06,
      0x05, 0x06, 0x06, 0x06, 0x07, 0x09, 0x08, 0x06, 0x07, 0x09, 0x07, 0x06, 0x06, 0x08, 0x0b, 0x08, 0x09, 0x0a,
      0x0a, 0x0a, 0x0a, 0x0a, 0x06, 0x08, 0x0b, 0x0c, 0x0b, 0x0a, 0x0c, 0x09, 0x0a, 0x0a, 0x0a, 0xff, 0xc0, 0x00,
      0x14, 0x08, 0x00, 0x08, 0x00, 0x08, 0x04, 0x43, 0x11, 0x00, 0x4d, 0x11, 0x00, 0x59, 0x11, 0x00, 0x4b, 0x11,
      0x00, 0xff, 0xc4, 0x00, 0x16, 0x00, 0x01, 0x01, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
      0x00, 0x00, 0x00, 0x00, 0x09, 0x00, 0x0a, 0xff, 0xc4, 0x00, 0x14, 0x10, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00,
      0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xff, 0xda, 0x00, 0x0e, 0x04, 0x43, 0x00,
      0x4d, 0x00, 0x59, 0x00, 0x4b, 0x00, 0x00, 0x3f, 0x00, 0x7f, 0x13, 0x3f, 0xe7, 0xf1, 0xff, 0xd9};
  OneImage one;
  WriteFile(one.folder / "images/a.jpg", std::string(reinterpret_cast<const char*>(bytes), sizeof(bytes)));
  one.Load("a.jpg", 8, 8);
  ASSERT_EQ(one.error, "");
  EXPECT_LT(cv::norm(one.image, cv::Mat(8, 8, CV_8UC3, cv::Scalar(0, 128, 255)), cv::NORM_INF), 3);
}

// An EXIF block that says "turned by 90 degrees" put behind the start-of-image marker.
std::string WithOrientation(const std::string& jpeg) {
  const std::string tiff("II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0", 26);
  const std::string body = std::string("Exif\0\0", 6) + tiff;
  const size_t length = body.size() + 2;
  return jpeg.substr(0, 2) + "\xff\xe1" + static_cast<char>(length >> 8) + static_cast<char>(length & 255) + body +
         jpeg.substr(2);
}

TEST(ProjectImages, ExifOrientationIsIgnoredAsColmapIgnoresIt) {
  OneImage one;
  Save(one.folder / "images/a.jpg", Gradient());
  const std::string turned = WithOrientation(ReadText(one.folder / "images/a.jpg"));
  WriteFile(one.folder / "images/a.jpg", turned);
  // The marker is there and a reader that heeds it turns the image.
  EXPECT_EQ(cv::imread((one.folder / "images/a.jpg").string()).cols, kHeight);
  one.Load("a.jpg");
  ASSERT_EQ(one.error, "");
  EXPECT_EQ(one.image.cols, kWidth);
}

TEST(ProjectImages, SizesMustAgreeWithTheCamera) {
  OneImage smaller, turned;
  Save(smaller.folder / "images/a.png", Gradient(6, 4));
  smaller.Load("a.png");
  EXPECT_THAT(smaller.error, HasSubstr("expected 12 x 8 pixels as the camera says, found 6 x 4"));
  Save(turned.folder / "images/a.png", Gradient(kHeight, kWidth));
  turned.Load("a.png");
  EXPECT_THAT(turned.error, HasSubstr("was the image turned"));
}

TEST(ProjectImages, DamagedFilesAreNamed) {
  const auto error_of = [](const std::string& name, const std::string& bytes, int size) {
    OneImage one;
    WriteFile(one.folder / ("images/" + name), bytes);
    one.Load(name, size, size);
    return one.error;
  };
  cv::Mat noise(256, 256, CV_8UC3);
  cv::randu(noise, 0, 255);
  std::vector<uchar> buffer;
  cv::imencode(".jpg", noise, buffer);
  const std::string jpeg(buffer.begin(), buffer.end());
  cv::imencode(".png", noise, buffer);
  const std::string png(buffer.begin(), buffer.end());

  EXPECT_EQ(error_of("a.jpg", jpeg, 256), "");
  EXPECT_EQ(error_of("a.jpg", jpeg + std::string(1000, '\0'), 256), "");  // padding after the end
  EXPECT_THAT(error_of("a.jpg", jpeg.substr(0, jpeg.size() / 2), 256), HasSubstr("expected a whole JPEG"));
  EXPECT_THAT(error_of("a.jpg", jpeg.substr(0, jpeg.size() - 20), 256), HasSubstr("expected a whole JPEG"));
  EXPECT_THAT(error_of("a.jpg", jpeg.substr(0, 100), 256), HasSubstr("expected a whole JPEG"));
  std::string damaged = jpeg;
  for (size_t i = 0; i < 40; ++i) damaged[damaged.size() / 2 + i] = '\xff';
  EXPECT_THAT(error_of("a.jpg", damaged, 256), HasSubstr("expected a whole JPEG"));
  EXPECT_THAT(error_of("a.png", png.substr(0, 60), 256), HasSubstr("cannot be decoded"));
  EXPECT_THAT(error_of("a.jpg", "this is no image", 256), HasSubstr("cannot be decoded"));
  EXPECT_THAT(error_of("a.jpg", "", 256), HasSubstr("empty file"));
}

TEST(ProjectImages, FloatingPointImagesAreRefused) {
  OneImage one;
  cv::Mat image;
  Gradient().convertTo(image, CV_32F, 1 / 255.0);
  Save(one.folder / "images/a.tiff", image);
  one.Load("a.tiff");
  EXPECT_THAT(one.error, HasSubstr("floating-point"));
}

TEST(ProjectImages, MissingImagesAreCountedUpToHalf) {
  const TemporaryFolder folder;
  for (const std::string name : {"a.png", "b.png", "c.png"}) Save(folder / ("images/" + name), Gradient());
  Warnings warnings;
  const ProjectImages images(SceneOf({"a.png", "b.png", "c.png", "x.png", "y.png"}), PathsOf(folder), warnings);
  EXPECT_EQ(images.size(), 5);
  EXPECT_THAT(images.missing(), testing::ElementsAre("x.png", "y.png"));
  EXPECT_THAT(warnings.messages,
              testing::Contains(HasSubstr("2 of 5 images are missing and left out, for example x.png")));
  cv::Mat image;
  EXPECT_TRUE(images.Load(2, image));
  EXPECT_FALSE(images.Load(3, image));
  EXPECT_THROW(ProjectImages(SceneOf({"a.png", "x.png", "y.png"}), PathsOf(folder)), InputError);
  ProjectPaths none = PathsOf(folder);
  none.images.clear();
  EXPECT_THROW(ProjectImages(SceneOf({"a.png"}), none), InputError);
}

TEST(ProjectImages, MasksInColmapsNaming) {
  const TemporaryFolder folder;
  for (const std::string name : {"a.jpg", "b.jpg"}) Save(folder / ("images/" + name), Gradient());
  cv::Mat mask = cv::Mat::zeros(kHeight, kWidth, CV_8UC1);
  mask(cv::Rect(2, 2, 4, 3)) = 255;
  Save(folder / "masks/a.jpg.png", mask);
  Warnings warnings;
  const ProjectImages images(SceneOf({"a.jpg", "b.jpg"}), PathsOf(folder), warnings);
  EXPECT_TRUE(images.has_masks());
  EXPECT_THAT(warnings.messages, testing::ElementsAre(HasSubstr("1 of 2 views have no mask")));
  cv::Mat loaded;
  EXPECT_FALSE(images.LoadMask(1, loaded));
  ASSERT_TRUE(images.LoadMask(0, loaded));
  EXPECT_EQ(loaded.type(), CV_8UC1);
  EXPECT_EQ(cv::countNonZero(loaded), 12);
  Save(folder / "masks/a.jpg.png", cv::Mat::zeros(3, 3, CV_8UC1));
  EXPECT_THROW(images.LoadMask(0, loaded), InputError);
}

TEST(MemoryImages, GiveWhatTheyHold) {
  const MemoryImages images({Gradient(), cv::Mat()}, {cv::Mat::ones(kHeight, kWidth, CV_8UC1), cv::Mat()});
  cv::Mat image;
  EXPECT_EQ(images.size(), 2);
  EXPECT_TRUE(images.Load(0, image));
  EXPECT_FALSE(images.Load(1, image));
  EXPECT_TRUE(images.LoadMask(0, image));
  EXPECT_FALSE(images.LoadMask(1, image));
}

TEST(WriteImage, PngIsExactAndDeterministic) {
  const TemporaryFolder folder;
  WriteImagePng(folder / "new/a.png", Gradient());
  WriteImagePng(folder / "b.png", Gradient());
  cv::Mat image;
  ReadImage(folder / "new/a.png", image);
  EXPECT_EQ(cv::norm(image, Gradient(), cv::NORM_INF), 0);
  EXPECT_EQ(ReadText(folder / "new/a.png"), ReadText(folder / "b.png"));
  WriteImageJpeg(folder / "c.jpg", Gradient());
  ReadImage(folder / "c.jpg", image);
  EXPECT_EQ(image.size(), Gradient().size());
}

}  // namespace
}  // namespace glint
