// What can go wrong around a run: signals at any moment, little memory, a clock that goes backwards, links in what was
// downloaded. A clear message, the right exit code, nothing half-written.
#include <gmock/gmock.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "io/mesh_io.h"
#include "io/vdb_io.h"
#include "tests/pipeline/program.h"
#include "tests/support/shared_folder.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kIsSanitized = true;  // a sanitizer's runtime needs all address space and wants to be loaded first
#else
constexpr bool kIsSanitized = false;
#endif

namespace glint {
namespace {

namespace fs = std::filesystem;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

class Faults : public ProgramTest {
 protected:
  static void SetUpTestSuite() { sound_ = testing_support::SharedFolder("faults_test", Make); }
  static void Make(const fs::path& folder) {
    const ProgramResult result =
        RunGlint({"synth", "sphere", "-o", folder.string(), "--views", "8", "--size", "160x120", "-q"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    // A coarse surface: what is tested is around the run, not in it.
    const std::string field = (folder / "field.vdb").string(), mesh = (folder / "coarse.ply").string();
    ASSERT_EQ(RunGlint({"sdf", (folder / "truth/mesh.ply").string(), "--voxel-rel", "0.02", "-o", field}).exit_code, 0);
    ASSERT_EQ(RunGlint({"mesh", field, "-o", mesh}).exit_code, 0);
  }

  static std::vector<std::string> Arguments(const std::string& project, const std::string& out) {
    return {"run",      project,
            "-o",       out,
            "--mesh",   (sound_ / "coarse.ply").string(),
            "--lights", (sound_ / "truth/lights.json").string(),
            "--set",    "refine.levels=1",
            "--set",    "refine.max_iterations=1",
            "--set",    "refine.voxel_rel=0.03"};
  }
  static std::vector<std::string> Arguments(const std::string& out) { return Arguments(sound_.string(), out); }

  // A project of its own, to be spoilt.
  fs::path Copied() const {
    fs::copy(sound_, folder_ / "p", fs::copy_options::recursive);
    return folder_ / "p";
  }

  static inline fs::path sound_;
};

// Every file under its final name is whole, and no other is left.
void ExpectOnlyWholeFiles(const fs::path& out) {
  if (!fs::exists(out)) return;
  for (const auto& entry : fs::recursive_directory_iterator(out)) {
    const fs::path& file = entry.path();
    EXPECT_FALSE(file.filename().string().starts_with(".tmp-")) << file;
    if (file.extension() == ".ply") {
      EXPECT_NO_THROW(ReadMesh(file)) << file;
    } else if (file.extension() == ".vdb") {
      EXPECT_NO_THROW(ReadVdb(file)) << file;
    } else if (file.extension() == ".json") {
      EXPECT_TRUE(nlohmann::json::accept(ReadText(file))) << file;
    }
  }
}

TEST_F(Faults, SignalsAtAnyMoment) {
  for (const auto& [signal, code] : {std::pair("INT", 130), std::pair("TERM", 143)}) {
    for (const char* seconds : {"0.03", "0.1", "0.2", "0.4"}) {
      const std::string out = Path(std::string("out_") + signal + seconds);
      const ProgramResult result =
          RunGlint(Arguments(out), std::string("timeout --preserve-status -s ") + signal + " " + seconds);
      EXPECT_THAT(result.exit_code, AnyOf(0, code)) << signal << " after " << seconds << " s\n" << result.err;
      EXPECT_THAT(result.err, Not(HasSubstr("bug")));
      ExpectOnlyWholeFiles(out);
    }
  }
}

TEST_F(Faults, AddressSpaceThatIsTooSmall) {
  if (kIsSanitized) GTEST_SKIP() << "a sanitizer needs the address space";
  bool succeeded = false;
  for (const int mib : {150, 250, 400, 700, 1000, 4000}) {
    const std::string out = Path("out_" + std::to_string(mib));
    const ProgramResult result = RunGlint(Arguments(out), "ulimit -v " + std::to_string(1024 * mib) + ";");
    // Below what its libraries take, the program does not even start (127).
    EXPECT_THAT(result.exit_code, AnyOf(0, 2, 127)) << mib << " MiB\n" << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr("bug"))) << mib << " MiB";
    if (result.exit_code == 2) {
      EXPECT_THAT(result.err, HasSubstr("memory")) << mib << " MiB";
    }
    ExpectOnlyWholeFiles(out);
    succeeded = result.exit_code == 0;
  }
  EXPECT_TRUE(succeeded) << "with 4000 MiB";
}

TEST_F(Faults, AVoxelSizeThatAnAddressSpaceLimitForbidsIsRefusedBeforehand) {
  if (kIsSanitized) GTEST_SKIP() << "a sanitizer needs the address space";
  std::vector<std::string> arguments = Arguments(Path("out"));
  arguments.back() = "refine.voxel_rel=0.0007";
  const ProgramResult result = RunGlint(arguments, "ulimit -v 3000000;");
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_THAT(result.err, HasSubstr("would fit"));
  EXPECT_FALSE(fs::exists(folder_ / "out/mesh.ply"));
}

TEST_F(Faults, AClockThatGoesBackwards) {
  if (kIsSanitized) GTEST_SKIP() << "a sanitizer's runtime must be loaded first";
  ASSERT_EQ(RunGlint(Arguments(Path("plain"))).exit_code, 0);
  const ProgramResult result = RunGlint(Arguments(Path("back")), "LD_PRELOAD='" GLINT_BACKWARDS_CLOCK "'");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(ReadText(Path("back/mesh.ply")) == ReadText(Path("plain/mesh.ply")));
  for (const auto& stage : nlohmann::json::parse(ReadText(Path("back/report.json")))["stages"])
    EXPECT_GE(stage["seconds"].get<double>(), 0) << stage;
}

TEST_F(Faults, NoInvalidFloatingPointOperation) {
  if (kIsSanitized) GTEST_SKIP() << "a sanitizer's runtime must be loaded first";
  const std::string trap = "LD_PRELOAD='" GLINT_TRAP_INVALID "'";
  const int caught = std::system((trap + " awk 'BEGIN { print log(-1) }' > '" + Path("awk") + "' 2>&1").c_str());
  ASSERT_EQ(WEXITSTATUS(caught), 98) << "the trap works";
  const ProgramResult result = RunGlint(Arguments(Path("out")), trap);
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST_F(Faults, ALinkOutOfTheProjectIsNotFollowedUnlessItsFolderIsNamed) {
  const fs::path project = Copied();
  fs::rename(project / "images/view_002.jpg", folder_ / "elsewhere.jpg");
  fs::create_symlink(folder_ / "elsewhere.jpg", project / "images/view_002.jpg");
  const ProgramResult refused = RunGlint(Arguments(project.string(), Path("out")));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, ::testing::AllOf(HasSubstr("view_002.jpg"), HasSubstr("link"), HasSubstr("--images")));
  auto arguments = Arguments(project.string(), Path("out"));
  arguments.insert(arguments.end(), {"--images", (project / "images").string()});
  EXPECT_EQ(RunGlint(arguments).exit_code, 0);
}

TEST_F(Faults, ALinkWithinTheProjectIsFollowed) {
  const fs::path project = Copied();
  fs::create_directories(project / "raw");
  fs::rename(project / "images/view_002.jpg", project / "raw/2.jpg");
  fs::create_symlink("../raw/2.jpg", project / "images/view_002.jpg");
  EXPECT_EQ(RunGlint(Arguments(project.string(), Path("out"))).exit_code, 0);
}

TEST_F(Faults, NothingIsWrittenThroughLinksOutOfTheOutputFolder) {
  for (const char* name : {"highlights", "highlight_masks", "stages"}) {
    fs::remove_all(folder_ / "out");
    fs::create_directories(folder_ / "out");
    fs::create_directories(folder_ / "elsewhere");
    fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "out" / name);
    const ProgramResult result = RunGlint(Arguments(Path("out")));
    EXPECT_EQ(result.exit_code, 2) << name;
    EXPECT_THAT(result.err, HasSubstr("link"));
    EXPECT_TRUE(fs::is_empty(folder_ / "elsewhere")) << name;
  }
}

TEST_F(Faults, LinksInPlaceOfResultsAreReplacedAndTheirTargetsKept) {
  fs::create_directories(folder_ / "out");
  Write("precious", "mine");
  for (const char* name : {"mesh.ply", "report.json", "log.txt", "seed.ply"})
    fs::create_symlink(folder_ / "precious", folder_ / "out" / name);
  EXPECT_EQ(RunGlint(Arguments(Path("out"))).exit_code, 0);
  EXPECT_EQ(ReadText(folder_ / "precious"), "mine");
  EXPECT_FALSE(fs::is_symlink(folder_ / "out/mesh.ply"));
}

TEST_F(Faults, MasksAreNotWrittenThroughLinks) {
  fs::create_directories(folder_ / "elsewhere");
  fs::create_directories(folder_ / "masks");
  fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "masks/overlays");
  const ProgramResult result = RunGlint({"detect", sound_.string(), "-o", Path("masks"), "--overlays"});
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_TRUE(fs::is_empty(folder_ / "elsewhere"));
}

}  // namespace
}  // namespace glint
