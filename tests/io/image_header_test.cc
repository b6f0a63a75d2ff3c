#include "io/image_header.h"

#include <gmock/gmock.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "io/project_images.h"
#include "tests/colmap/test_model.h"

namespace glint {
namespace {

using testing::HasSubstr;
using testing_support::TemporaryFolder;
using testing_support::WriteFile;

std::string Encoded(const char* extension, int type, const std::vector<int>& options = {}) {
  std::vector<uchar> bytes;
  EXPECT_TRUE(cv::imencode(extension, cv::Mat(33, 47, type, cv::Scalar::all(99)), bytes, options));
  return {bytes.begin(), bytes.end()};
}

TEST(ImageHeader, SaysTheSizeOfEveryFormat) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"JPEG", Encoded(".jpg", CV_8UC3)},
      {"JPEG", Encoded(".jpg", CV_8UC1, {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_RST_INTERVAL, 2})},
      {"PNG", Encoded(".png", CV_8UC4)},
      {"PNG", Encoded(".png", CV_16UC1)},
      {"TIFF", Encoded(".tif", CV_16UC3)},
      {"BMP", Encoded(".bmp", CV_8UC3)},
      {"WebP", Encoded(".webp", CV_8UC3)},
      {"WebP", Encoded(".webp", CV_8UC4, {cv::IMWRITE_WEBP_QUALITY, 101})},
      {"PNM", Encoded(".ppm", CV_8UC3)},
      {"PNM", Encoded(".pgm", CV_16UC1)},
      {"PNM", "P5 # a comment\n# another\n 47\n33 255\n" + std::string(47 * 33, 'x')}};
  for (const auto& [format, bytes] : cases) {
    const auto header = ReadImageHeader(bytes);
    ASSERT_TRUE(header) << format;
    EXPECT_EQ(header->format, format);
    EXPECT_EQ(header->width, 47u) << format;
    EXPECT_EQ(header->height, 33u) << format;
    EXPECT_FALSE(ClaimsTooMuch(*header, bytes.size())) << format;
    for (size_t size = 0; size < bytes.size(); ++size) ReadImageHeader(std::string_view(bytes).substr(0, size));
  }
}

TEST(ImageHeader, OtherFilesAreNoImages) {
  for (const char* text : {"", "P", "P5", "P5 12", "GIF89a", "RIFF....WAVE", "hello", "MM", "\xFF\xD8\xFF\xE0"})
    EXPECT_FALSE(ReadImageHeader(text)) << text;
}

TEST(ImageHeader, PlainImagesCompressFarAndAreBelieved) {
  std::vector<uchar> bytes;
  const cv::Mat plain(3000, 4000, CV_8UC1, cv::Scalar(255));
  ASSERT_TRUE(cv::imencode(".png", plain, bytes, {cv::IMWRITE_PNG_COMPRESSION, 9, cv::IMWRITE_PNG_BILEVEL, 1}));
  EXPECT_FALSE(ClaimsTooMuch({"PNG", 4000, 3000}, bytes.size())) << bytes.size() << " bytes";
}

// What is refused from its first bytes: no decoder gets to allocate gigabytes for it.
TEST(ImageHeader, SizesThatAFileCannotHoldAreRefused) {
  const TemporaryFolder folder;
  const auto expect_refused = [&](const std::string& bytes, const std::string& said) {
    WriteFile(folder / "image", bytes);
    cv::Mat image;
    try {
      ReadImage(folder / "image", image);
      ADD_FAILURE() << "expected a refusal";
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr(said));
    }
  };
  std::string png = Encoded(".png", CV_8UC3);
  png.replace(16, 8, std::string("\x00\x00\x75\x30\x00\x00\x75\x30", 8));
  expect_refused(png, "claims 30000 x 30000 pixels");
  std::string jpeg = Encoded(".jpg", CV_8UC1);
  const size_t frame = jpeg.find("\xFF\xC0");
  ASSERT_NE(frame, std::string::npos);
  jpeg.replace(frame + 5, 4, "\xFF\xDC\xFF\xDC");
  expect_refused(jpeg, "claims 65500 x 65500 pixels");
  expect_refused("P6 900000 900000 255\n123", "claims 900000 x 900000 pixels");
}

}  // namespace
}  // namespace glint
