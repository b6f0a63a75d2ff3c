// Models and images that exist in the wild, each through the program: an error or a warning that names the record,
// never a crash, never another geometry without a word.
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/pipeline/spoilt_project.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class WildModel : public SpoiltProject {
 protected:
  // Reads model and images, and looks for highlights in them.
  ProgramResult Detect(const std::string& out = "masks") const {
    return RunGlint({"detect", Path("p"), "-o", Path(out)});
  }
  template <class Matcher>
  void ExpectRefused(const Matcher& message) const {
    const ProgramResult result = Detect();
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_THAT(result.err, AllOf(message, Not(HasSubstr("bug"))));
  }
  template <class Matcher>
  void ExpectWarning(const Matcher& message) const {
    const ProgramResult result = Detect();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, AllOf(HasSubstr("warning"), message));
  }
};

fs::path Real(const std::string& name) { return fs::path(GLINT_SOURCE_DIR) / "../shared/data/real" / name; }

TEST_F(WildModel, CutInBothFiles) {
  if (!fs::exists(Real("stitch_truncated"))) GTEST_SKIP() << "no " << Real("stitch_truncated");
  const ProgramResult result = RunGlint({"run", Real("stitch_truncated").string(), "-o", Path("out")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("images.bin: image 14 of 82"), HasSubstr("cut at 2359296 bytes")));
  ExpectNoResults(folder_ / "out");
}

TEST_F(WildModel, PosesThatDoNotBelongToThePoints) {
  if (!fs::exists(Real("tumbler"))) GTEST_SKIP() << "no " << Real("tumbler");
  const ProgramResult result = RunGlint({"run", Real("tumbler/sparse_zeroed").string(), "-o", Path("out")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("the poses do not belong to the points"));
  ExpectNoResults(folder_ / "out");
}

TEST_F(WildModel, QuaternionNotOfUnitLengthAndPixelsAtZero) {
  ChangeModel([](Model& model) {
    model.images[2].cam_from_world.rotation.coeffs() *= 1.5;
    for (Point2D& point : model.images[3].points2d) point.px.setZero();
  });
  ExpectWarning(AllOf(HasSubstr("images.bin"), HasSubstr("quaternion"), HasSubstr("(0, 0)")));
}

TEST_F(WildModel, TracksThatReferToWhatIsNotThere) {
  ChangeModel([](Model& model) { model.points[4].track[0].image_id = 999; });
  ExpectWarning(HasSubstr("999"));
  Restore();
  ChangeModel([](Model& model) { model.images[1].points2d[0].point3d_id = 987654; });
  ExpectWarning(HasSubstr("987654"));
}

TEST_F(WildModel, IdsThatComeTwice) {
  ChangeModel([](Model& model) { model.images[3].id = model.images[2].id; });
  ExpectRefused(AllOf(HasSubstr("images.bin"), HasSubstr("found it twice")));
  Restore();
  ChangeModel([](Model& model) { model.points[3].id = model.points[2].id; });
  ExpectRefused(AllOf(HasSubstr("points3D.bin"), HasSubstr("found it twice")));
}

std::string Bytes(const cv::Mat& image, const std::string& extension) {
  std::vector<uchar> bytes;
  cv::imencode(extension, image, bytes);
  return {bytes.begin(), bytes.end()};
}

TEST_F(WildModel, ImageThatIsTurnedByExifIsSeenAsColmapSawIt) {
  ASSERT_EQ(Detect("plain").exit_code, 0);
  const std::string tiff("II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0", 26);
  const std::string exif = std::string("\xff\xe1\0\x22", 4) + std::string("Exif\0\0", 6) + tiff;
  for (const auto& entry : fs::directory_iterator(folder_ / "p/images")) {
    const std::string jpeg = ReadText(entry.path());
    Write("p/images/" + entry.path().filename().string(), jpeg.substr(0, 2) + exif + jpeg.substr(2));
  }
  ASSERT_EQ(cv::imread(Path("p/images/view_000.jpg")).cols, 120) << "a reader that heeds it turns the image";
  ASSERT_EQ(Detect("turned").exit_code, 0);
  for (const auto& entry : fs::directory_iterator(folder_ / "plain"))
    EXPECT_EQ(ReadText(entry.path()), ReadText(folder_ / "turned" / entry.path().filename())) << entry.path();
}

TEST_F(WildModel, GreyAndSixteenBitImagesServe) {
  const cv::Mat image = cv::imread(Path("p/images/view_001.jpg"));
  cv::Mat grey, deep;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  image.convertTo(deep, CV_16U, 257);
  for (const std::string& bytes : {Bytes(grey, ".jpg"), Bytes(grey, ".png"), Bytes(deep, ".png")}) {
    Write("p/images/view_001.jpg", bytes);
    const ProgramResult result = Detect();
    EXPECT_EQ(result.exit_code, 0) << result.err;
  }
}

TEST_F(WildModel, DamagedJpegIsNamed) {
  const std::string jpeg = ReadText(folder_ / "p/images/view_001.jpg");
  std::string damaged = jpeg;
  for (size_t i = 0; i < 40; ++i) damaged[damaged.size() / 2 + i] = '\xff';
  for (const std::string& bytes : {damaged, jpeg.substr(0, jpeg.size() / 2)}) {
    Write("p/images/view_001.jpg", bytes);
    ExpectRefused(HasSubstr("view_001.jpg"));
  }
}

}  // namespace
}  // namespace glint
