// The main job from photographs or a film, through the program, with a script in place of COLMAP; and what the real one
// makes of our masks and meshes.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "io/mesh_io.h"
#include "pipeline/image_stages.h"
#include "tests/colmap/fake_colmap.h"
#include "tests/pipeline/program.h"
#include "tests/support/shared_folder.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing_support::FakeColmap;

bool HasColmap() { return std::system("command -v colmap > /dev/null 2>&1") == 0; }

class FromPhotographs : public ProgramTest {
 protected:
  static void SetUpTestSuite() { project_ = testing_support::SharedFolder("photographs_test", Make); }
  static void Make(const fs::path& folder) {
    const ProgramResult result =
        RunGlint({"synth", "ellipsoid", "-o", folder.string(), "--views", "12", "--size", "320x240", "-q"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  FromPhotographs() : colmap_(folder_ / "bin") {
    fs::copy(project_ / "images", folder_ / "photographs", fs::copy_options::recursive);
    fs::copy(project_ / "sparse", colmap_.Model(), fs::copy_options::recursive);
  }

  ProgramResult RunOn(const std::string& what, const std::vector<std::string>& more = {},
                      const std::string& prefix = "") const {
    std::vector<std::string> arguments = {
        "run", Path(what), "-o", Path("out"), "--set", "refine.voxel_rel=0.02", "--set", "seed.smooth.edge_rel=0.03"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunGlint(arguments, "PATH='" + Path("bin") + "':\"$PATH\" " + prefix);
  }

  // COLMAP takes mesh.ply as points with normals and colours and makes the same surface of them; assimp, behind which
  // are many programs, counts the same vertices in every format.
  void ExpectOthersReadIt(const TriangleMesh& mesh) const {
    if (HasColmap()) {
      const std::string command = "QT_QPA_PLATFORM=offscreen colmap poisson_mesher --input_path '" +
                                  Path("out/mesh.ply") + "' --output_path '" + Path("poisson.ply") +
                                  "' --PoissonMeshing.depth 6 --PoissonMeshing.trim 0 > /dev/null 2>&1";
      EXPECT_EQ(std::system(command.c_str()), 0);
      EXPECT_NEAR(Diagonal(ReadMesh(Path("poisson.ply"))), Diagonal(mesh), 0.02 * Diagonal(mesh));
    }
    // Debian's MeshLab needs a display, even for this, and fails an assertion of its own on every OBJ.
    if (std::system("command -v meshlabserver > /dev/null && command -v xvfb-run > /dev/null") == 0) {
      const std::string command = "timeout 60 xvfb-run -a meshlabserver -i '" + Path("out/mesh.ply") + "' -o '" +
                                  Path("again.ply") + "' > '" + Path("info") + "' 2>&1";
      EXPECT_EQ(std::system(command.c_str()), 0);
      EXPECT_THAT(ReadText(Path("info")), HasSubstr(" loaded has " + std::to_string(mesh.vertices.size()) + " vn " +
                                                    std::to_string(mesh.faces.size()) + " fn"));
    }
    if (std::system("command -v CloudCompare > /dev/null 2>&1") == 0) {
      const std::string command = "QT_QPA_PLATFORM=offscreen timeout 60 CloudCompare -SILENT -O '" +
                                  Path("out/mesh.ply") + "' > '" + Path("info") + "' 2>&1";
      EXPECT_EQ(std::system(command.c_str()), 0);
      EXPECT_THAT(ReadText(Path("info")),
                  HasSubstr("one mesh with " + std::to_string(mesh.faces.size()) + " faces and " +
                            std::to_string(mesh.vertices.size()) + " vertices"));
    }
    ExpectBlenderReadsIt(mesh);
    if (std::system("command -v assimp > /dev/null 2>&1") != 0) return;
    for (const char* name : {"out/mesh.ply", "out/mesh.obj", "out/mesh.glb"}) {
      EXPECT_EQ(std::system(("assimp info '" + Path(name) + "' > '" + Path("info") + "' 2>&1").c_str()), 0) << name;
      EXPECT_THAT(ReadText(Path("info")), HasSubstr(" " + std::to_string(mesh.vertices.size()) + "\n")) << name;
    }
  }

  // Meshes with their colours, and the field by the name of its grid.
  void ExpectBlenderReadsIt(const TriangleMesh& mesh) const {
    if (std::system("command -v blender > /dev/null 2>&1") != 0) return;
    Write("read.py", R"(
import bpy, numpy, sys
numpy.bool = bool  # Debian's reader of glTF uses a name that Debian's NumPy has dropped
folder = sys.argv[-1]
for name, read in (("mesh.ply", bpy.ops.import_mesh.ply), ("mesh.obj", bpy.ops.wm.obj_import),
                   ("mesh.glb", bpy.ops.import_scene.gltf)):
    read(filepath=folder + "/" + name)
    mesh = [o for o in bpy.context.selected_objects if o.type == "MESH"][0].data
    print("read", name, len(mesh.vertices), len(mesh.polygons), len(mesh.color_attributes))
bpy.ops.object.volume_import(filepath=folder + "/sdf.vdb")
grids = bpy.context.object.data.grids
grids.load()
print("read", *[(g.name, g.data_type, g.channels) for g in grids])
)");
    const std::string command = "timeout 120 blender --background --factory-startup --python-exit-code 1 --python '" +
                                Path("read.py") + "' -- '" + Path("out") + "' > '" + Path("info") + "' 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << ReadText(Path("info"));
    const std::string counts = std::to_string(mesh.vertices.size()) + " " + std::to_string(mesh.faces.size());
    for (const std::string name : {"mesh.ply", "mesh.obj", "mesh.glb"})
      EXPECT_THAT(ReadText(Path("info")), HasSubstr("read " + name + " " + counts + " 1"));
    EXPECT_THAT(ReadText(Path("info")), HasSubstr("read ('surface', 'FLOAT', 1)"));
  }

  static inline fs::path project_;
  FakeColmap colmap_;
};

TEST_F(FromPhotographs, OneCommandToTheMesh) {
  Write("photographs/cut.jpg", ReadText(project_ / "images/view_000.jpg").substr(0, 3000));
  const std::vector<std::string> more = {
      "--lights", (project_ / "truth/lights.json").string(), "--set", "output.obj=true", "--set", "output.glb=true"};
  const ProgramResult result = RunOn("photographs", more);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("left out"), HasSubstr("cut.jpg"), HasSubstr("12 of 12 images registered")));
  EXPECT_THAT(colmap_.Calls(), ElementsAre("feature_extractor", "exhaustive_matcher", "mapper"));
  EXPECT_THAT(colmap_.Lines(), HasSubstr("--ImageReader.single_camera 1"));
  const auto report = nlohmann::json::parse(ReadText(folder_ / "out/report.json"));
  EXPECT_THAT(report.dump(), AllOf(HasSubstr("colmap features"), HasSubstr("COLMAP 3.8")));
  EXPECT_EQ(report["versions"]["COLMAP"], "3.8");
  for (const char* library : {"CGAL", "Ceres", "OpenCV", "OpenVDB", "compiler"})
    EXPECT_THAT(report["versions"].value(library, ""), ::testing::ContainsRegex("[0-9]+\\.[0-9]")) << library;

  const TriangleMesh mesh = ReadMesh(folder_ / "out/mesh.ply");
  ASSERT_EQ(mesh.colors.size(), mesh.vertices.size());
  EXPECT_EQ(ReadMesh(folder_ / "out/mesh.obj").colors.size(), mesh.vertices.size());
  EXPECT_THAT(ReadText(folder_ / "out/mesh.glb").substr(0, 4), "glTF");
  EXPECT_TRUE(fs::exists(folder_ / "out/highlight_masks/view_003.jpg.png"));
  ExpectOthersReadIt(mesh);

  EXPECT_EQ(RunOn("photographs", more).exit_code, 0);
  EXPECT_THAT(colmap_.Calls(), IsEmpty()) << "what is finished is not done again";
}

TEST_F(FromPhotographs, AStageLikeOthers) {
  EXPECT_EQ(RunOn("photographs", {"--until", "photos"}).exit_code, 0);
  EXPECT_EQ(colmap_.Calls().size(), 3u);
  EXPECT_TRUE(fs::is_directory(folder_ / "out/colmap/sparse"));
  EXPECT_FALSE(fs::exists(folder_ / "out/seed.ply"));
  Write("out/colmap/stale", "of a run before");
  EXPECT_EQ(RunOn("photographs", {"--from", "seed", "--until", "seed"}).exit_code, 0);
  EXPECT_THAT(colmap_.Calls(), IsEmpty());
  EXPECT_EQ(RunOn("photographs", {"--from", "photos", "--until", "photos"}).exit_code, 0);
  EXPECT_EQ(colmap_.Calls().size(), 3u) << "done anew";
  EXPECT_FALSE(fs::exists(folder_ / "out/colmap/stale"));
}

TEST_F(FromPhotographs, MissingColmapIsNamedWithHowToInstallIt) {
  const ProgramResult result = RunGlint({"run", Path("photographs"), "-o", Path("out")}, "PATH=/nowhere ");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("apt-get install colmap"), Not(HasSubstr("bug"))));
  ExpectNoResults(folder_ / "out");
}

TEST_F(FromPhotographs, FailingColmapIsQuoted) {
  colmap_.Write("exhaustive_matcher", "echo 'ERROR: out of luck' >&2; exit 9");
  const ProgramResult result = RunOn("photographs");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("exhaustive_matcher"), HasSubstr("exit code 9"), HasSubstr("out of luck"),
                                HasSubstr("log.txt")));
  ExpectNoResults(folder_ / "out");
}

TEST_F(FromPhotographs, TooFewRegisteredComesWithAdvice) {
  fs::remove_all(colmap_.Model() / "0");
  const ProgramResult result = RunOn("photographs");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, AllOf(HasSubstr("0 of 12"), HasSubstr("90 features"), HasSubstr("turntable")));
}

TEST_F(FromPhotographs, CtrlCEndsColmapAndKeepsWhatIsFinished) {
  colmap_.Write("mapper", "sleep 60 & echo $! > " + Path("pid") + "; wait");
  const ProgramResult result = RunOn("photographs", {}, InterruptWhen("[ -s \"" + Path("pid") + "\" ]"));
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_FALSE(testing_support::Runs(folder_ / "pid"));
  EXPECT_TRUE(fs::exists(folder_ / "out/colmap/matches.done"));
}

TEST_F(FromPhotographs, WhatIsNeitherProjectNorPhotographsNorFilm) {
  Write("notes.txt", "not a film");
  fs::create_directories(folder_ / "empty");
  EXPECT_THAT(RunOn("notes.txt").err, AllOf(HasSubstr("notes.txt"), HasSubstr("film")));
  EXPECT_THAT(RunOn("empty").err, AllOf(HasSubstr("empty"), HasSubstr("COLMAP project")));
  Write("phone/1.heic", "x");
  const ProgramResult result = RunOn("phone");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr(".heic"), HasSubstr("JPEG")));
}

TEST_F(FromPhotographs, FilmGivesFrames) {
  cv::Mat wide(240, 700, CV_8UC3), small(60, 175, CV_8UC3);
  cv::theRNG().state = 1;
  cv::randu(small, 0, 255);
  cv::resize(small, wide, wide.size(), 0, 0, cv::INTER_CUBIC);
  {
    cv::VideoWriter film(Path("film.avi"), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25, {320, 240});
    for (int i = 0; i < 60; ++i) film.write(wide(cv::Rect(6 * i, 0, 320, 240)).clone());  // it reads whole rows
  }
  fs::remove_all(colmap_.Model() / "0");
  EXPECT_EQ(RunOn("film.avi").exit_code, 3);
  const fs::path images = folder_ / "out/colmap/images";
  EXPECT_GE(std::distance(fs::directory_iterator(images), {}), 10);
  EXPECT_THAT(ReadText(folder_ / "out/colmap/photographs.txt"), HasSubstr("frame_0000"));
  const auto written = fs::last_write_time(*fs::directory_iterator(images));
  EXPECT_EQ(RunOn("film.avi").exit_code, 3);
  EXPECT_EQ(fs::last_write_time(*fs::directory_iterator(images)), written) << "the frames are taken once";
}

TEST_F(FromPhotographs, MasksOfAnEarlierRunGoBackToColmap) {
  const std::vector<std::string> back = {"--masks-back", "--until", "photos"};
  const ProgramResult too_early = RunOn("photographs", back);
  EXPECT_EQ(too_early.exit_code, 2);
  EXPECT_THAT(too_early.err, AllOf(HasSubstr("highlight_masks"), HasSubstr("run first without --masks-back")));
  EXPECT_EQ(RunOn("photographs", {"--until", "photos"}).exit_code, 0);
  EXPECT_THAT(colmap_.Lines(), Not(HasSubstr("mask_path")));
  colmap_.Calls();

  Write("out/highlight_masks/view_000.jpg.png", "of an earlier run");
  EXPECT_EQ(RunOn("photographs", back).exit_code, 0);
  EXPECT_THAT(colmap_.Lines(), HasSubstr("--ImageReader.mask_path " + Path("out/feature_masks")));
  EXPECT_THAT(colmap_.Calls(), ElementsAre("feature_extractor", "exhaustive_matcher", "mapper"));
  Write("out/highlight_masks/view_000.jpg.png", "of the run just done");
  EXPECT_EQ(RunOn("photographs", back).exit_code, 0);
  EXPECT_THAT(colmap_.Calls(), IsEmpty()) << "what is finished is not done again";
  EXPECT_EQ(ReadText(folder_ / "out/feature_masks/view_000.jpg.png"), "of an earlier run");
  EXPECT_EQ(RunOn("photographs", {"--masks-back", "--from", "photos", "--until", "photos"}).exit_code, 0);
  EXPECT_EQ(ReadText(folder_ / "out/feature_masks/view_000.jpg.png"), "of the run just done");

  const ProgramResult given =
      RunGlint({"run", project_.string(), "-o", Path("other"), "--masks-back", "--until", "photos"});
  EXPECT_EQ(given.exit_code, 2);
  EXPECT_THAT(given.err, HasSubstr("is a COLMAP project"));
}

// What COLMAP does with our masks: no features where they are 0, that is on highlights.
TEST_F(FromPhotographs, ColmapIgnoresFeaturesOnHighlights) {
  if (!HasColmap()) GTEST_SKIP() << "no colmap program";
  cv::Mat image(240, 320, CV_8UC3, cv::Scalar::all(90));
  cv::theRNG().state = 1;
  cv::Mat spots(60, 60, CV_8UC3);
  cv::randu(spots, 0, 255);
  cv::resize(spots(cv::Rect(0, 0, 20, 20)), image(cv::Rect(40, 80, 80, 80)), {80, 80}, 0, 0, cv::INTER_CUBIC);
  Scene scene;
  std::vector<Highlight> highlights;
  for (uint32_t k = 0; k < 2; ++k) {
    View& view = scene.views.emplace_back();
    view.name = k == 0 ? "clear.png" : "with/glint.png";
    view.camera = {1, CameraModel::kPinhole, 320, 240, {300, 300, 160, 120}};
    fs::create_directories((folder_ / "film" / view.name).parent_path());
    cv::imwrite((folder_ / "film" / view.name).string(), image);
  }
  Highlight glint;
  glint.view = 1;
  glint.px = {80, 120};
  glint.covariance_px = Eigen::Matrix2d::Identity();
  glint.moments_px = 1600 * Eigen::Matrix2d::Identity();
  highlights.push_back(glint);
  WriteHighlightMasks(scene, highlights, folder_ / "masks", Progress::Silent());
  const std::string command = "QT_QPA_PLATFORM=offscreen colmap feature_extractor --database_path '" + Path("db") +
                              "' --image_path '" + Path("film") + "' --ImageReader.mask_path '" + Path("masks") +
                              "' --SiftExtraction.use_gpu 0 > '" + Path("said") + "' 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0) << ReadText(folder_ / "said");
  const std::string said = ReadText(folder_ / "said");
  const auto features = [&](const std::string& name) {
    const size_t at = said.find("Features:", said.find(name));
    return std::stoi(said.substr(at + 9));
  };
  EXPECT_GT(features("clear.png"), 20) << said;
  EXPECT_EQ(features("with/glint.png"), 0) << said;
}

}  // namespace
}  // namespace glint
