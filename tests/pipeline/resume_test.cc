// A run that goes on from an earlier one, whatever became of that: through the program, on a small scene.
#include <gmock/gmock.h>

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "pipeline/run.h"
#include "tests/pipeline/small_scene.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::json;

constexpr const char* kResults[] = {"mesh.ply", "sdf.vdb", "seed.ply", "lights.json", "config.yaml"};

class Resume : public SmallScene {
 protected:
  // Runs, well, and says which stages were done although an earlier run had done them.
  std::vector<std::string> Redone(const std::string& out, const std::vector<std::string>& more = {}) const {
    const ProgramResult result = Run(out, more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    std::vector<std::string> redone;
    std::istringstream lines(result.err);
    for (std::string line; std::getline(lines, line);)
      if (const size_t colon = line.find(": done anew"); colon != std::string::npos)
        redone.push_back(line.substr(0, colon));
    return redone;
  }
  void RunWell(const std::string& out, const std::vector<std::string>& more = {}) const { Redone(out, more); }

  // Every result, and the report without what times and commands are in it.
  std::map<std::string, std::string> Results(const std::string& out) const {
    std::map<std::string, std::string> results;
    for (const char* name : kResults) results[name] = ReadText(folder_ / out / name);
    Json report = Json::parse(ReadText(folder_ / out / "report.json"));
    RemoveTimes(report);
    results["report.json"] = report.dump(1);
    std::string& page = results["report.html"] = ReadText(folder_ / out / "report.html");
    const size_t times = page.find("id=\"glint-run\"");
    EXPECT_NE(times, std::string::npos);
    page.erase(times, page.find("</script>", times) - times);
    return results;
  }
  static void RemoveTimes(Json& json) {
    if (json.is_object())
      for (const char* key : {"seconds", "total_seconds", "command", "reused"}) json.erase(key);
    for (Json& child : json)
      if (child.is_structured()) RemoveTimes(child);
  }
  void ExpectSameResults(const std::string& a, const std::string& b) const {
    const auto of_a = Results(a), of_b = Results(b);
    for (const auto& [name, text] : of_a) {
      EXPECT_FALSE(text.empty()) << name;
      EXPECT_TRUE(text == of_b.at(name)) << name << " differs between " << a << " and " << b;
    }
  }
  void ExpectNoTemporaries(const std::string& out) const {
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / out))
      EXPECT_FALSE(entry.path().filename().string().starts_with(".tmp-")) << entry.path();
    EXPECT_FALSE(fs::exists(folder_ / out / "stages/new"));
  }
};

TEST_F(Resume, OnlyWhatAChangeReachesIsDoneAgain) {
  EXPECT_THAT(Redone("out"), IsEmpty());
  const auto first = Results("out");
  const std::string report = ReadText(folder_ / "out/report.json");

  const ProgramResult again = Run("out");
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.err, AllOf(HasSubstr("nothing to do"), HasSubstr("--force")));
  EXPECT_EQ(ReadText(folder_ / "out/report.json"), report) << "nothing is written";

  const ProgramResult fewer = Run("out", {"--set", "refine.max_iterations=2"});
  EXPECT_THAT(fewer.err, HasSubstr("refine: done anew: refine.max_iterations was 4, is 2"));
  EXPECT_THAT(Redone("out"), ElementsAre("refine", "report"));
  EXPECT_TRUE(Results("out") == first) << "back to the first options, back to the first results";

  EXPECT_THAT(Redone("out", {"--set", "output.overlay_max_side_px=100"}), ElementsAre("report"));
  EXPECT_EQ(Redone("out", {"--set", "detect.position_floor_px=0.06"}).front(), "detect");
  EXPECT_EQ(Redone("out", {"--set", "given_mesh.point_distance_rel=0.5"}).front(), "seed");
}

TEST_F(Resume, InputsAndLostFilesAreNoticed) {
  RunWell("out");
  const auto first = Results("out");
  fs::remove(folder_ / "out/stages/highlights.json");
  EXPECT_THAT(Redone("out"), ElementsAre("gate")) << "it leaves what it left before, so refinement stays";
  Write("out/mesh.ply", "spoilt");
  EXPECT_EQ(Redone("out").front(), "refine");
  EXPECT_TRUE(Results("out") == first);
  // The same pixels in another file: the stages that look at images run, and come to the same.
  std::ofstream(folder_ / "p/images/view_003.jpg", std::ios::app | std::ios::binary) << '\0';
  EXPECT_THAT(Redone("out"), ElementsAre("seed", "detect", "lights", "gate", "refine", "report"));
  EXPECT_TRUE(Results("out") == first);
}

TEST_F(Resume, FromUntilAndForce) {
  const ProgramResult part = Run("out", {"--until", "gate"});
  EXPECT_EQ(part.exit_code, 0) << part.err;
  EXPECT_THAT(part.err, HasSubstr("stopped after gate"));
  EXPECT_TRUE(fs::exists(folder_ / "out/stages/highlights.json"));
  ExpectNoResults(folder_ / "out");
  RunWell("out");
  const auto first = Results("out");

  EXPECT_THAT(Redone("out", {"--from", "gate"}), ElementsAre("gate", "refine", "report"));
  EXPECT_TRUE(Results("out") == first);
  const ProgramResult other = Run("out", {"--from", "refine", "--set", "gate.paint_ratio=0.5"});
  EXPECT_EQ(other.exit_code, 0);
  EXPECT_THAT(other.err, AllOf(HasSubstr("warning: gate"), HasSubstr("gate.paint_ratio was 0.55, is 0.5")));
  EXPECT_THAT(Redone("out", {"--force"}), ElementsAre("seed", "detect", "lights", "gate", "refine", "report"));
  EXPECT_TRUE(Results("out") == first);
  EXPECT_EQ(Run("out", {"--from", "refine", "--until", "seed"}).exit_code, 2);
  EXPECT_EQ(Run("out", {"--from", "refine", "--force"}).exit_code, 2);
}

TEST_F(Resume, TheSameAtAnyNumberOfThreadsAndInPieces) {
  // A scene with a seed of its own, made from its points.
  ASSERT_EQ(RunGlint({"synth", "ellipsoid", "-o", Path("e"), "--views", "12", "--size", "160x120", "-q"}).exit_code, 0);
  const auto run_well = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {
        "run", Path("e"), "-o", Path(out), "--lights", Path("e/truth/lights.json"), "--config", Path("c.yaml")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = RunGlint(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
  };
  run_well("whole", {"--threads", "4"});
  int threads = 1;
  for (const char* stage : {"seed", "detect", "lights", "gate", "refine"})
    run_well("pieces", {"--until", stage, "--threads", std::to_string(threads++ % 3 + 1)});
  run_well("pieces", {"--threads", "1"});
  ExpectSameResults("whole", "pieces");
}

TEST_F(Resume, GoesOnAfterKill) {
  const auto start = std::chrono::steady_clock::now();
  RunWell("whole");
  const double whole_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::mt19937 random(7);
  for (int i = 0; i < 3; ++i) {
    const double after_s = std::uniform_real_distribution<>(0, whole_s)(random);
    Run("killed", {}, "timeout -s KILL " + std::to_string(after_s));
    RunWell("killed");
    ExpectSameResults("whole", "killed");
    ExpectNoTemporaries("killed");
    fs::remove_all(folder_ / "killed");
  }
}

TEST_F(Resume, NoResultSetsAnEarlierOneAside) {
  RunWell("out");
  const std::string mesh = ReadText(folder_ / "out/mesh.ply");
  const ProgramResult none = Run("out", {"--set", "detect.min_strength=1"});
  EXPECT_EQ(none.exit_code, 3) << none.err;
  EXPECT_THAT(none.err, HasSubstr("earlier/"));
  EXPECT_FALSE(fs::exists(folder_ / "out/mesh.ply"));
  EXPECT_TRUE(ReadText(folder_ / "out/earlier/mesh.ply") == mesh);
  EXPECT_THAT(Json::parse(ReadText(folder_ / "out/report.json"))["outcome"].get<std::string>(), HasSubstr("highlight"));
  EXPECT_EQ(Json::parse(ReadText(folder_ / "out/earlier/report.json"))["outcome"], "done");
  EXPECT_EQ(Run("out", {"--set", "detect.min_strength=1"}).exit_code, 3) << "and it stays so";
  RunWell("out");
  EXPECT_TRUE(ReadText(folder_ / "out/mesh.ply") == mesh);
}

// Whether this machine lets us mount a small file system that only the test sees.
bool CanMount() { return std::system("unshare -Urm true 2> /dev/null") == 0; }

TEST_F(Resume, AFullDiskLosesNothing) {
  if (!CanMount()) GTEST_SKIP() << "no mounting here (unshare -Urm)";
  RunWell("whole");
  size_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "whole"))
    if (entry.is_regular_file()) bytes += entry.file_size() / 4096 * 4096 + 4096;
  // An earlier result on a disk that has no room for another beside it.
  for (const double room : {0.3, 0.9}) {
    const std::string size = std::to_string(static_cast<size_t>(room * static_cast<double>(bytes)) / 1024);
    fs::create_directories(folder_ / "disk");
    Write("inside.sh", "mount -t tmpfs -o size=" + size + "k tmpfs '" + Path("disk") + "' && mkdir '" +
                           Path("disk/out") + "' && echo old > '" + Path("disk/out/mesh.ply") +
                           "' && \"$@\"; code=$?; ls -aR '" + Path("disk/out") + "' > '" + Path("left") + "'; cp '" +
                           Path("disk/out/mesh.ply") + "' '" + Path("mesh") + "'; exit $code");
    const ProgramResult result = Run("disk/out", {}, "unshare -Urm sh '" + Path("inside.sh") + "'");
    EXPECT_EQ(result.exit_code, 2) << room << ": " << result.err;
    EXPECT_THAT(result.err, AnyOf(HasSubstr("No space left on device"), HasSubstr("is the disk full?"))) << room;
    EXPECT_THAT(ReadText(folder_ / "left"), ::testing::Not(HasSubstr(".tmp-"))) << room;
    const std::string mesh = ReadText(folder_ / "mesh");
    EXPECT_TRUE(mesh == "old\n" || mesh == ReadText(folder_ / "whole/mesh.ply")) << room << ": the old mesh or the new";
  }
}

TEST_F(Resume, AnOutputThatCannotBeWrittenIsNamed) {
  if (!CanMount()) GTEST_SKIP() << "no mounting here (unshare -Urm)";
  fs::create_directories(folder_ / "ro");
  Write("inside.sh", "mount -t tmpfs -o ro tmpfs '" + Path("ro") + "' && \"$@\"");
  for (const char* out : {"ro", "ro/out"}) {
    const ProgramResult result = Run(out, {}, "unshare -Urm sh '" + Path("inside.sh") + "'");
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_THAT(result.err, AllOf(HasSubstr(Path("ro")), HasSubstr("Read-only file system")));
  }
}

TEST_F(Resume, AFileThatVanishesInTheMeantimeIsNamedAndTheNextRunMends) {
  RunWell("out");
  const auto first = Results("out");
  fs::remove(folder_ / "out/stages/start.ply");
  const ProgramResult result = Run("out", {"--from", "refine"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("stages/start.ply"));
  EXPECT_TRUE(Results("out") == first) << "the results stay";
  RunWell("out");
  EXPECT_TRUE(Results("out") == first);
}

}  // namespace
}  // namespace glint
