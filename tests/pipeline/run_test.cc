// The main job end to end, through the program, on a small rendered scene.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "light/light_io.h"
#include "tests/pipeline/shared_run.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using Json = nlohmann::json;

class Run : public SharedRun {
 protected:
  static Json Compare(const fs::path& mesh) {
    const ProgramResult result = RunGlint({"compare", mesh.string(), (shared_ / "p/truth/mesh.ply").string(), "--json",
                                           "--project", Project(), "--lights", Lights(), "-q"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out)["candidates"][0];
  }
  static double SweptNormalError(const fs::path& mesh) {
    return Compare(mesh)["regions"]["swept region"]["normal_deg"]["mean"];
  }

  // A folder in which the seed and the candidates of the shared run are done: they take half of a run's time.
  std::string WithSeedAndCandidates(const std::string& name) const {
    const fs::path out = folder_ / name;
    fs::create_directories(out);
    fs::copy(Out() / "stages", out / "stages", fs::copy_options::recursive);
    fs::copy(Out() / "seed.ply", out / "seed.ply");
    for (const char* stage : {"lights", "gate", "refine", "report"})
      fs::remove(out / "stages" / (std::string(stage) + ".record.json"));
    return out.string();
  }
};

// What may differ between two runs of the same thing.
void RemoveTimes(Json& json) {
  if (json.is_object())
    for (const char* key : {"seconds", "total_seconds", "command", "reused"}) json.erase(key);
  for (Json& child : json)
    if (child.is_structured()) RemoveTimes(child);
}

Json Report(const fs::path& out) {
  Json report = Json::parse(ReadText(out / "report.json"));
  RemoveTimes(report);
  return report;
}

// report.html without its element of what may differ: command and times.
std::string Page(const fs::path& out) {
  std::string page = ReadText(out / "report.html");
  const size_t begin = page.find("id=\"glint-run\""), end = page.find("</script>", begin);
  EXPECT_LT(begin, end);
  EXPECT_NE(end, std::string::npos);
  return page.erase(begin, end - begin);
}

TEST_F(Run, WritesEveryResult) {
  for (const char* name : {"mesh.ply", "sdf.vdb", "seed.ply", "lights.json", "config.yaml", "report.html",
                           "report.json", "log.txt", "highlights/view_000.jpg.png", "highlights/view_011.jpg.png"})
    EXPECT_TRUE(fs::exists(Out() / name)) << name;
  EXPECT_THAT(ReadText(Out() / "mesh.ply").substr(0, 1000),
              AllOf(HasSubstr("property float nx"), HasSubstr("property float confidence")));
  const Json report = Report(Out());
  EXPECT_EQ(report["outcome"], "done");
  EXPECT_EQ(report["project"]["views"], kNumViews);
  EXPECT_GT(report["highlights"]["gate"]["accepted"], 5);
  EXPECT_FALSE(report["refine"]["iterations"].empty());
  EXPECT_THAT(RunGlint({"inspect", (Out() / "mesh.ply").string()}).out, HasSubstr("closed       yes"));
  EXPECT_EQ(RunGlint({"inspect", (Out() / "sdf.vdb").string()}).exit_code, 0);
}

TEST_F(Run, ResolvedConfigurationRepeatsTheRun) {
  EXPECT_THAT(ReadText(Out() / "config.yaml"), HasSubstr("voxel_rel: 0.03\n"));
  const ProgramResult result = RunGlint({"config", "--config", (Out() / "config.yaml").string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("voxel_rel: 0.03\n"));
}

TEST_F(Run, ImprovesTheSurfaceWhereHighlightsPass) {
  const double before = SweptNormalError(Out() / "seed.ply"), after = SweptNormalError(Out() / "mesh.ply");
  EXPECT_LT(after, before / 2) << "before " << before << " deg, after " << after << " deg";
}

TEST_F(Run, TheGainComesFromTheHighlights) {
  const ProgramResult result =
      RunGlint(Arguments(WithSeedAndCandidates("off"), {"--set", "refine.use_highlights=false"}, false));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_GT(SweptNormalError(Path("off") + "/mesh.ply"), 1.3 * SweptNormalError(Out() / "mesh.ply"));
}

TEST_F(Run, ByteIdenticalAtAnyNumberOfThreads) {
  ASSERT_EQ(RunGlint(Arguments(Path("one"), {"--threads", "1", "-q"})).exit_code, 0);
  for (const char* name : {"seed.ply", "mesh.ply", "sdf.vdb", "lights.json", "config.yaml", "stages/candidates.json",
                           "stages/highlights.json", "highlights/view_007.jpg.png"})
    EXPECT_TRUE(ReadText(folder_ / "one" / name) == ReadText(Out() / name)) << name;
  EXPECT_EQ(Report(folder_ / "one"), Report(Out()));
  EXPECT_TRUE(Page(folder_ / "one") == Page(Out()));
}

TEST_F(Run, GoesOnFromAnyStageToTheSameMesh) {
  const std::string mesh = ReadText(Out() / "mesh.ply");
  for (const char* stage : {"refine", "lights"}) {
    fs::remove_all(folder_ / "again");
    fs::copy(Out(), folder_ / "again", fs::copy_options::recursive);
    fs::remove(folder_ / "again/mesh.ply");
    const ProgramResult result = RunGlint(Arguments(Path("again"), {"--from", stage}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(ReadText(folder_ / "again/mesh.ply") == mesh) << stage;
    EXPECT_TRUE(Json::parse(ReadText(folder_ / "again/report.json"))["stages"][1]["reused"]);
  }
}

TEST_F(Run, StagesOfAnotherProjectAreNotTaken) {
  fs::copy(Out(), folder_ / "again", fs::copy_options::recursive);
  Write("again/stages/points_on_object.txt", "0101\n");
  const ProgramResult result = RunGlint(Arguments(Path("again"), {"--from", "refine"}));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("points_on_object.txt"), HasSubstr("another project")));
}

TEST_F(Run, LightsThatNobodyGaveAreFound) {
  const ProgramResult result = RunGlint(Arguments(WithSeedAndCandidates("found"), {}, false));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::vector<Light> truth = ReadLights(Lights()), found = ReadLights(folder_ / "found/lights.json");
  ASSERT_EQ(found.size(), truth.size());
  for (const Light& t : truth) {
    double nearest_deg = 180;
    for (const Light& f : found) {
      EXPECT_EQ(f.type, LightType::kDistant);
      EXPECT_EQ(f.frame, LightFrame::kWorld);
      nearest_deg = std::min(nearest_deg, std::acos(std::min(1.0, t.vector.dot(f.vector))) * 180 / M_PI);
    }
    EXPECT_LT(nearest_deg, 3);
  }
  EXPECT_THAT(result.err, HasSubstr("detect: taken from the earlier run"));
  const Json lights = Report(folder_ / "found")["lights"];
  EXPECT_TRUE(lights["given"].empty());
  EXPECT_EQ(lights["found"]["lights"].size(), truth.size());
}

TEST_F(Run, TooFewHighlightsForALightAreSaidAndKept) {
  const ProgramResult result =
      RunGlint(Arguments(WithSeedAndCandidates("dark"), {"--set", "lights.min_support=1000"}, false));
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, AllOf(HasSubstr("--lights"), HasSubstr(Path("dark"))));
  for (const char* name : {"seed.ply", "report.html", "report.json", "highlights/view_000.jpg.png"})
    EXPECT_TRUE(fs::exists(folder_ / "dark" / name)) << name;
  EXPECT_FALSE(fs::exists(folder_ / "dark/mesh.ply"));
  EXPECT_THAT(Report(folder_ / "dark")["outcome"].get<std::string>(), HasSubstr("lights"));
}

TEST_F(Run, LightsThatExplainNothingGiveNoResult) {
  // From below, where the object has no surface that mirrors it to the cameras.
  Write("lights.json", R"({"lights": [{"type": "distant", "frame": "camera", "direction_to_light": [0, 0, 1]}]})");
  const ProgramResult result =
      RunGlint(Arguments(WithSeedAndCandidates("wrong"), {"--lights", Path("lights.json")}, false));
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_FALSE(fs::exists(folder_ / "wrong/mesh.ply"));
}

TEST_F(Run, AMissingImageIsCountedAndLeftOut) {
  fs::copy(Project(), folder_ / "p", fs::copy_options::recursive);
  fs::remove(folder_ / "p/images/view_004.jpg");
  const ProgramResult result = RunGlint(ArgumentsFor(Path("p"), Path("out"), {}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("warning"));
  EXPECT_EQ(Report(folder_ / "out")["project"]["missing_images"], 1);
  EXPECT_FALSE(fs::exists(folder_ / "out/highlights/view_004.jpg.png"));
}

TEST_F(Run, AMeshInPlaceOfTheSeed) {
  const ProgramResult result = RunGlint(Arguments(Path("given"), {"--mesh", (Out() / "seed.ply").string(), "-q"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  // From facets the contacts may go on moving: the one thing that -q lets through here.
  EXPECT_THAT(result.err, AnyOf("", MatchesRegex("warning: the contacts still moved[^\n]*\n")));
  EXPECT_LT(SweptNormalError(Path("given") + "/mesh.ply"), SweptNormalError(Out() / "seed.ply"));
}

TEST_F(Run, CtrlCStopsAndLeavesNothingHalfWritten) {
  const ProgramResult result =
      RunGlint(Arguments(Path("stopped"), {"--set", "refine.voxel_rel=0.002", "--set", "refine.max_iterations=100"}),
               InterruptWhen("grep -qs \"gate: done\" \"" + Path("stopped/log.txt") + "\""));
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_THAT(result.err, HasSubstr("stopped"));
  ExpectNoResults(folder_ / "stopped");
}

TEST_F(Run, TwoRunsDoNotShareAFolder) {
  const std::string first =
      "'" GLINT_PROGRAM "' run '" + Project() + "' -o '" + Path("busy") + "' --lights '" + Lights() +
      "' -q --set refine.voxel_rel=0.002 --set refine.max_iterations=100 2> /dev/null & echo $! > '" + Path("pid") +
      "'; sleep 1;";
  const ProgramResult second = RunGlint(Arguments(Path("busy"), {}), first);
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.err, HasSubstr("another run"));
  const std::string pid = std::to_string(std::stoi(ReadText(Path("pid"))));
  EXPECT_EQ(std::system(("kill " + pid + "; while kill -0 " + pid + " 2> /dev/null; do sleep 0.05; done").c_str()), 0);
}

}  // namespace
}  // namespace glint
