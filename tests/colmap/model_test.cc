#include "colmap/model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <functional>

#include "colmap/scene.h"
#include "core/error.h"
#include "tests/colmap/test_model.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ReadText;
using testing_support::SmallModel;
using testing_support::TemporaryFolder;
using testing_support::WriteFile;

void ExpectSame(const Model& a, const Model& b) {
  ASSERT_EQ(a.cameras.size(), b.cameras.size());
  for (const auto& [id, camera] : a.cameras) {
    ASSERT_TRUE(b.cameras.contains(id));
    const Camera& other = b.cameras.at(id);
    EXPECT_EQ(camera.id, other.id);
    EXPECT_EQ(camera.model, other.model);
    EXPECT_EQ(camera.width, other.width);
    EXPECT_EQ(camera.height, other.height);
    EXPECT_EQ(camera.params, other.params);
  }
  ASSERT_EQ(a.images.size(), b.images.size());
  for (size_t i = 0; i < a.images.size(); ++i) {
    const Image &x = a.images[i], &y = b.images[i];
    EXPECT_EQ(x.id, y.id);
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.camera_id, y.camera_id);
    EXPECT_EQ(x.cam_from_world.rotation.coeffs(), y.cam_from_world.rotation.coeffs());
    EXPECT_EQ(x.cam_from_world.translation, y.cam_from_world.translation);
    ASSERT_EQ(x.points2d.size(), y.points2d.size());
    for (size_t k = 0; k < x.points2d.size(); ++k) {
      EXPECT_EQ(x.points2d[k].px, y.points2d[k].px);
      EXPECT_EQ(x.points2d[k].point3d_id, y.points2d[k].point3d_id);
    }
  }
  ASSERT_EQ(a.points.size(), b.points.size());
  for (size_t i = 0; i < a.points.size(); ++i) {
    const Point3D &x = a.points[i], &y = b.points[i];
    EXPECT_EQ(x.id, y.id);
    EXPECT_EQ(x.xyz, y.xyz);
    EXPECT_EQ(x.rgb, y.rgb);
    EXPECT_EQ(x.error_px, y.error_px);
    ASSERT_EQ(x.track.size(), y.track.size());
    for (size_t k = 0; k < x.track.size(); ++k) {
      EXPECT_EQ(x.track[k].image_id, y.track[k].image_id);
      EXPECT_EQ(x.track[k].point2d_index, y.track[k].point2d_index);
    }
  }
}

TEST(Model, BinaryAndTextAreReadBackToTheLastBit) {
  const Model model = SmallModel();
  for (const ModelFormat format : {ModelFormat::kBinary, ModelFormat::kText}) {
    const TemporaryFolder folder;
    WriteModel(model, folder / "sparse/0", format);
    const Model read = ReadModel(folder / "sparse/0");
    ExpectSame(model, read);
    EXPECT_THAT(read.warnings, testing::IsEmpty());
  }
}

TEST(Model, BinaryIsReadWhereBothFormatsLie) {
  const TemporaryFolder folder;
  WriteModel(SmallModel(4), folder.path(), ModelFormat::kBinary);
  WriteModel(SmallModel(2), folder.path(), ModelFormat::kText);
  EXPECT_EQ(ReadModel(folder.path()).images.size(), 4);
}

TEST(Model, WritingTwiceGivesTheSameBytes) {
  const TemporaryFolder a, b;
  for (const ModelFormat format : {ModelFormat::kBinary, ModelFormat::kText}) {
    WriteModel(SmallModel(), a.path(), format);
    WriteModel(SmallModel(), b.path(), format);
    for (const auto& entry : fs::directory_iterator(a.path())) {
      EXPECT_EQ(ReadText(entry.path()), ReadText(b / entry.path().filename().string())) << entry.path();
    }
  }
}

TEST(Model, EveryCameraModelPassesThroughBothFormats) {
  for (int id = 0; id < 18; ++id) {
    Model model = SmallModel(1, 0);
    Camera camera{1, static_cast<CameraModel>(id), 640, 480, {}};
    for (size_t i = 0; i < *CameraModelNumParams(id); ++i) camera.params.push_back(i < 4 ? 100.0 + 3 * id : 0.125 * i);
    if (id == 16) camera.params = {500, 500, 320, 240, 0.5, 1.2};
    model.cameras = {{1, camera}};
    ASSERT_FALSE(CameraProblem(camera)) << *CameraProblem(camera);
    for (const ModelFormat format : {ModelFormat::kBinary, ModelFormat::kText}) {
      const TemporaryFolder folder;
      WriteModel(model, folder.path(), format);
      ExpectSame(model, ReadModel(folder.path()));
    }
  }
}

// --- text as people and other programs write it ---

constexpr const char* kCamerasText = "# comment\n1 PINHOLE 640 480 500 500 320 240\n";
constexpr const char* kImagesText =
    "1 1 0 0 0 0 0 2 1 a.jpg\n10 20 5 11.5 21.5 -1\n2 1 0 0 0 0.1 0 2 1 b c.jpg\n12 22 5\n";
constexpr const char* kPointsText = "5 0.1 0.2 0.3 1 2 3 0.5 1 0 2 0\n";

void WriteTextModel(const fs::path& folder, const std::string& cameras, const std::string& images,
                    const std::string& points) {
  WriteFile(folder / "cameras.txt", cameras);
  WriteFile(folder / "images.txt", images);
  WriteFile(folder / "points3D.txt", points);
}

TEST(ModelText, CommentsBlankLinesWindowsLineEndsAndSpacesInNames) {
  const TemporaryFolder folder;
  std::string images = "\xEF\xBB\xBF# list\r\n\r\n";
  for (const char c : std::string(kImagesText)) images += c == '\n' ? "\r\n" : std::string(1, c);
  WriteTextModel(folder.path(), kCamerasText, images, kPointsText);
  const Model model = ReadModel(folder.path());
  ASSERT_EQ(model.images.size(), 2);
  EXPECT_EQ(model.images[1].name, "b c.jpg");
  EXPECT_EQ(model.images[0].points2d[1].point3d_id, kInvalidPoint3DId);
  EXPECT_THAT(model.warnings, testing::IsEmpty());
}

TEST(ModelText, ImagesWithoutPoints) {
  const TemporaryFolder folder;
  // As written by programs that know poses only: an empty line after each image, and an empty points3D.txt.
  WriteTextModel(folder.path(), kCamerasText, "1 1 0 0 0 0 0 2 1 a.jpg\n\n2 1 0 0 0 0.1 0 2 1 b.jpg\n\n", "");
  const Model model = ReadModel(folder.path());
  EXPECT_EQ(model.images.size(), 2);
  EXPECT_EQ(model.points.size(), 0);
  EXPECT_THAT(model.warnings, testing::ElementsAre(HasSubstr("no 3D points")));
}

// --- rigs and frames of COLMAP 4.x ---

TEST(ModelFrames, PosesComeFromRigsAndFrames) {
  const TemporaryFolder folder;
  const std::string cameras = "1 PINHOLE 640 480 500 500 320 240\n2 PINHOLE 640 480 500 500 320 240\n";
  // The second camera is mounted 1 to the right of the first, turned half a turn about y.
  const std::string images = "1 1 0 0 0 0 0 2 1 a.jpg\n\n2 1 0 0 0 9 9 9 2 b.jpg\n\n";
  WriteTextModel(folder.path(), cameras, images, "");
  WriteFile(folder / "rigs.txt", "# rigs\n1 3 CAMERA 1 IMU 4 0 CAMERA 2 1 0 0 1 0 -1 0 0\n");
  WriteFile(folder / "frames.txt", "1 1 1 0 0 0 0 0 2 3 CAMERA 1 1 CAMERA 2 2 IMU 4 77\n");
  const Model model = ReadModel(folder.path());
  ASSERT_EQ(model.images.size(), 2);
  EXPECT_TRUE(model.images[0].cam_from_world.translation.isApprox(Eigen::Vector3d(0, 0, 2)));
  // sensor_from_rig * rig_from_world: half a turn about y of (0, 0, 2), then the shift.
  EXPECT_TRUE(model.images[1].cam_from_world.translation.isApprox(Eigen::Vector3d(-1, 0, -2)));
  EXPECT_THAT(model.warnings, testing::Contains(HasSubstr("image 2 'b.jpg': the pose of its frame")));
}

TEST(ModelFrames, BinaryRigsAndFrames) {
  const TemporaryFolder folder;
  WriteModel(SmallModel(), folder.path());
  const auto bytes = [](auto... values) {
    std::string out;
    (out.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
    return out;
  };
  const Model model = SmallModel();
  std::string rigs = bytes(uint64_t{3}), frames = bytes(uint64_t{model.images.size()});
  for (const auto& [id, camera] : model.cameras) rigs += bytes(id, uint32_t{1}, int32_t{0}, id);
  for (const Image& image : model.images) {
    const auto& q = image.cam_from_world.rotation;
    const auto& t = image.cam_from_world.translation;
    frames += bytes(image.id, image.camera_id, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z(), uint32_t{1}, int32_t{0},
                    image.camera_id, uint64_t{image.id});
  }
  WriteFile(folder / "rigs.bin", rigs);
  WriteFile(folder / "frames.bin", frames);
  const Model read = ReadModel(folder.path());
  ExpectSame(model, read);
  EXPECT_THAT(read.warnings, testing::IsEmpty());
  WriteFile(folder / "frames.bin", frames.substr(0, frames.size() - 3));
  EXPECT_THROW(ReadModel(folder.path()), InputError);
}

// --- hostile input ---

struct BadText {
  std::string name, cameras, images, points;
  std::vector<std::string> message;  // parts of the error
};

class BadTextModel : public testing::TestWithParam<BadText> {};

INSTANTIATE_TEST_SUITE_P(
    Hostile, BadTextModel,
    testing::Values(
        BadText{"UnknownCameraModel",
                "1 PERSPECTIVE 640 480 1 1 1\n",
                kImagesText,
                kPointsText,
                {"cameras.txt", "line 1 (camera 1)", "PERSPECTIVE"}},
        BadText{"TooFewParams",
                "1 PINHOLE 640 480 500 320 240\n",
                kImagesText,
                kPointsText,
                {"cameras.txt", "camera 1", "expected 4 parameters (fx, fy, cx, cy) for PINHOLE, found 3"}},
        BadText{"NegativeFocal",
                "1 PINHOLE 640 480 -500 500 320 240\n",
                kImagesText,
                kPointsText,
                {"camera 1", "positive focal length", "-500"}},
        BadText{"NanParam", "1 PINHOLE 640 480 500 nan 320 240\n", kImagesText, kPointsText, {"camera 1", "finite"}},
        BadText{"HugeImage", "1 PINHOLE 64000000 480 500 500 320 240\n", kImagesText, kPointsText, {"64000000"}},
        BadText{"NegativeSize", "1 PINHOLE -640 480 500 500 320 240\n", kImagesText, kPointsText, {"width", "'-640'"}},
        BadText{"CameraTwice",
                std::string(kCamerasText) + kCamerasText,
                kImagesText,
                kPointsText,
                {"camera 1", "found it twice"}},
        BadText{"CameraMissing",
                "3 PINHOLE 640 480 500 500 320 240\n",
                kImagesText,
                kPointsText,
                {"images.txt", "image 1 'a.jpg'", "expected camera 1 in cameras.txt, found 3"}},
        BadText{"NoImages", kCamerasText, "# none\n", kPointsText, {"images.txt", "at least one registered image"}},
        BadText{"ImageTwice",
                kCamerasText,
                "1 1 0 0 0 0 0 2 1 a.jpg\n\n1 1 0 0 0 0 0 2 1 b.jpg\n\n",
                "",
                {"image 1", "found it twice"}},
        BadText{"NameTwice",
                kCamerasText,
                "1 1 0 0 0 0 0 2 1 a.jpg\n\n2 1 0 0 0 0 0 2 1 a.jpg\n\n",
                "",
                {"image 2 'a.jpg'", "image 1 has it too"}},
        BadText{"NanPose", kCamerasText, "1 1 0 0 0 nan 0 2 1 a.jpg\n\n", "", {"line 1 (image 1)", "finite pose"}},
        BadText{"InfinitePose", kCamerasText, "1 1 0 0 0 1e999 0 2 1 a.jpg\n\n", "", {"finite pose"}},
        BadText{"FarPose", kCamerasText, "1 1 0 0 0 1e40 0 2 1 a.jpg\n\n", "", {"finite pose within 1e+30"}},
        BadText{"ZeroQuaternion", kCamerasText, "1 0 0 0 0 0 0 2 1 a.jpg\n\n", "", {"image 1", "unit quaternion"}},
        BadText{"NoName", kCamerasText, "1 1 0 0 0 0 0 2 1\n\n", "", {"image 1", "image name"}},
        BadText{"ShortLine", kCamerasText, "1 1 0 0 0\n\n", "", {"line 1", "QW QX QY QZ TX TY TZ"}},
        BadText{"NameLeavesFolder", kCamerasText, "1 1 0 0 0 0 0 2 1 x/../../a.jpg\n\n", "", {"image 1", "'..'"}},
        BadText{"AbsoluteName", kCamerasText, "1 1 0 0 0 0 0 2 1 /etc/passwd\n\n", "", {"image 1", "absolute"}},
        BadText{"PointLineMissing",
                kCamerasText,
                "1 1 0 0 0 0 0 2 1 a.jpg\n2 1 0 0 0 0 0 2 1 b.jpg\n",
                "",
                {"line 2 (image 1)", "2D point as X Y POINT3D_ID"}},
        BadText{"HalfAPoint2D", kCamerasText, "1 1 0 0 0 0 0 2 1 a.jpg\n1 2\n", "", {"line 2", "end of the line"}},
        BadText{"NanPoint",
                kCamerasText,
                kImagesText,
                "5 0.1 nan 0.3 1 2 3 0.5 1 0 2 0\n",
                {"points3D.txt", "point 5", "finite position"}},
        BadText{"FarPoint",
                kCamerasText,
                kImagesText,
                "5 0.1 -1e40 0.3 1 2 3 0.5 1 0 2 0\n",
                {"points3D.txt", "point 5", "within 1e+30"}},
        BadText{"PointsTooNear",
                kCamerasText,
                kImagesText,
                "5 0 0 0 1 2 3 0.5 1 0 2 0\n6 1e-40 0 0 1 2 3 0.5\n",
                {"points3D.txt", "lie apart by more than 1e-30", "scale the model up"}},
        BadText{"PointTwice",
                kCamerasText,
                kImagesText,
                std::string(kPointsText) + kPointsText,
                {"point 5", "found it twice"}},
        BadText{"ColorTooLarge", kCamerasText, kImagesText, "5 0.1 0 0.3 1 256 3 0.5 1 0\n", {"point 5", "'256'"}},
        BadText{"HalfATrackElement",
                kCamerasText,
                kImagesText,
                "5 0.1 0 0.3 1 2 3 0.5 1 0 2\n",
                {"point 5", "IMAGE_ID POINT2D_IDX"}},
        BadText{"NotANumber",
                kCamerasText,
                kImagesText,
                "5 0.1 zero 0.3 1 2 3 0.5 1 0\n",
                {"line 1 (point 5)", "found 'zero'"}}),
    [](const auto& test) { return test.param.name; });

TEST_P(BadTextModel, SaysFileRecordAndWhatWasExpected) {
  const TemporaryFolder folder;
  WriteTextModel(folder.path(), GetParam().cameras, GetParam().images, GetParam().points);
  try {
    ReadModel(folder.path());
    FAIL() << "was read";
  } catch (const InputError& error) {
    for (const std::string& part : GetParam().message) EXPECT_THAT(error.what(), HasSubstr(part));
    EXPECT_THAT(error.path(), HasSubstr(folder.path().string()));
  }
}

struct Repaired {
  std::string name, images, points, warning;
  size_t num_observations;
};

class RepairedTextModel : public testing::TestWithParam<Repaired> {};

INSTANTIATE_TEST_SUITE_P(
    Hostile, RepairedTextModel,
    testing::Values(
        Repaired{"LongQuaternion", "1 2 0 0 0 0 0 2 1 a.jpg\n10 20 5\n2 1 0 0 0 0 0 2 1 b.jpg\n12 22 5\n", kPointsText,
                 "image 1): expected a unit quaternion, found one of length 2; normalised", 2},
        Repaired{"TrackToMissingImage", kImagesText, "5 0.1 0.2 0.3 1 2 3 0.5 1 0 2 0 9 0\n",
                 "point 5: its track refers to 2D point 0 of image 9, which is not in the model", 2},
        Repaired{"TrackToMissingPoint2D", kImagesText, "5 0.1 0.2 0.3 1 2 3 0.5 1 0 2 17\n",
                 "2D point 17 of image 2, which has fewer", 1},
        Repaired{"TrackContradicted", kImagesText, "5 0.1 0.2 0.3 1 2 3 0.5 1 1 2 0\n", "does not refer back", 1},
        Repaired{"PointMissing", kImagesText, "", "image 1 'a.jpg': 2D point 0 refers to point 5, which is missing", 0},
        Repaired{"NanPoint2D", "1 1 0 0 0 0 0 2 1 a.jpg\nnan 20 5\n2 1 0 0 0 0 0 2 1 b.jpg\n12 22 5\n", kPointsText,
                 "does not refer back", 1},
        Repaired{"ListedTwiceInATrack", kImagesText, "5 0.1 0.2 0.3 1 2 3 0.5 1 0 1 0 2 0\n", "", 2},
        Repaired{"NanError", kImagesText, "5 0.1 0.2 0.3 1 2 3 nan 1 0 2 0\n", "", 2}),
    [](const auto& test) { return test.param.name; });

TEST_P(RepairedTextModel, IsReadWithAWarning) {
  const TemporaryFolder folder;
  WriteTextModel(folder.path(), kCamerasText, GetParam().images, GetParam().points);
  const Model model = ReadModel(folder.path());
  if (GetParam().warning.empty()) {
    EXPECT_THAT(model.warnings, testing::IsEmpty());
  } else {
    EXPECT_THAT(model.warnings, testing::Contains(HasSubstr(GetParam().warning)));
  }
  size_t num_observations = 0;
  for (const Point3D& point : model.points) num_observations += point.track.size();
  EXPECT_EQ(num_observations, GetParam().num_observations);
  for (const Image& image : model.images) EXPECT_NEAR(image.cam_from_world.rotation.norm(), 1, 1e-12);
  // Whatever was repaired can be used, and written and read again without a complaint about it.
  EXPECT_EQ(MakeScene(model).views.size(), model.images.size());
}

// Calls `use` for each file of a sound model; `use` may change the file.
void ForEveryFile(const std::function<void(const fs::path& file, const std::string& bytes)>& use) {
  const TemporaryFolder folder;
  WriteModel(SmallModel(2, 3), folder.path());
  for (const std::string name : {"cameras.bin", "images.bin", "points3D.bin"}) {
    const std::string bytes = ReadText(folder / name);
    use(folder / name, bytes);
    WriteFile(folder / name, bytes);
  }
}

TEST(ModelBinary, EveryCutIsAnErrorThatNamesTheFile) {
  ForEveryFile([](const fs::path& file, const std::string& bytes) {
    for (size_t size = bytes.size(); size-- > 0;) {
      fs::resize_file(file, size);
      try {
        ReadModel(file.parent_path());
        FAIL() << file << " cut at " << size << " was read";
      } catch (const InputError& error) {
        EXPECT_EQ(error.path(), file.string()) << size;
      }
    }
  });
}

TEST(ModelBinary, DamagedBytesAreAnErrorOrAreReadButNeverCrash) {
  int num_errors = 0;
  ForEveryFile([&](const fs::path& file, const std::string& bytes) {
    for (size_t i = 0; i < bytes.size(); ++i) {
      std::string changed = bytes;
      changed[i] = std::array{'\x00', '\x7f', '\xff'}[i % 3];
      WriteFile(file, changed);
      try {
        MakeScene(ReadModel(file.parent_path()));
      } catch (const InputError&) {
        ++num_errors;
      }
    }
  });
  EXPECT_GT(num_errors, 50);
}

TEST(ModelBinary, HugeCountsAreRefusedBeforeAnythingIsAllocated) {
  const TemporaryFolder folder;
  for (const std::string file : {"cameras.bin", "images.bin", "points3D.bin"}) {
    WriteModel(SmallModel(2, 3), folder.path());
    std::string bytes = ReadText(folder / file);
    for (size_t i = 0; i < 7; ++i) bytes[i] = '\xff';
    WriteFile(folder / file, bytes);
    try {
      ReadModel(folder.path());
      FAIL() << file;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("the file is cut"));
    }
  }
}

TEST(ModelBinary, TrailingBytesAreMentioned) {
  const TemporaryFolder folder;
  WriteModel(SmallModel(2, 3), folder.path());
  WriteFile(folder / "images.bin", ReadText(folder / "images.bin") + "abc");
  EXPECT_THAT(ReadModel(folder.path()).warnings, testing::ElementsAre(HasSubstr("found 3 more bytes")));
}

TEST(ModelBinary, MissingFilesAreNamed) {
  for (const std::string file : {"cameras.bin", "images.bin", "points3D.bin"}) {
    const TemporaryFolder folder;
    WriteModel(SmallModel(2, 3), folder.path());
    fs::remove(folder / file);
    try {
      ReadModel(folder.path());
      FAIL() << file;
    } catch (const InputError& error) {
      EXPECT_THAT(error.path(), testing::EndsWith(file));
    }
  }
  EXPECT_THROW(ReadModel("/no/such/folder"), InputError);
}

TEST(Model, APipeInPlaceOfAFileIsRefusedAtOnce) {
  for (const ModelFormat format : {ModelFormat::kBinary, ModelFormat::kText}) {
    const TemporaryFolder folder;
    WriteModel(SmallModel(2, 3), folder.path(), format);
    const fs::path file = folder / (format == ModelFormat::kBinary ? "images.bin" : "images.txt");
    fs::remove(file);
    ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
    EXPECT_THROW(ReadModel(folder.path()), InputError);
  }
}

}  // namespace
}  // namespace glint
