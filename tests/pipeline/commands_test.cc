// The commands other than run, through the program.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/pipeline/program.h"

namespace glint {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// A unit cube, 12 faces.
constexpr const char* kCube = R"(OFF
8 12 0
0 0 0
1 0 0
1 1 0
0 1 0
0 0 1
1 0 1
1 1 1
0 1 1
3 0 2 1
3 0 3 2
3 4 5 6
3 4 6 7
3 0 1 5
3 0 5 4
3 1 2 6
3 1 6 5
3 2 3 7
3 2 7 6
3 3 0 4
3 3 4 7
)";

class Commands : public ProgramTest {};

TEST_F(Commands, VersionAndHelp) {
  const ProgramResult version = RunGlint({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out, HasSubstr("glint " GLINT_VERSION));
  const ProgramResult help = RunGlint({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* command :
       {"run", "synth", "detect", "sdf", "mesh", "render", "compare", "inspect", "light", "config"})
    EXPECT_THAT(help.out, HasSubstr(command));
}

TEST_F(Commands, WrongCommandLinesAreBadInput) {
  const ProgramResult none = RunGlint({});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, AllOf(HasSubstr("compare"), HasSubstr("inspect")));
  const ProgramResult misspelt = RunGlint({"rum", "project"});
  EXPECT_EQ(misspelt.exit_code, 2);
  EXPECT_THAT(misspelt.err, HasSubstr("rum: unknown command; the nearest is run"));
  const ProgramResult flag = RunGlint({"run", "project", "-oout", "--form=seed"});
  EXPECT_EQ(flag.exit_code, 2);
  EXPECT_THAT(flag.err, AllOf(HasSubstr("--form: unknown flag; the nearest is --from"), Not(HasSubstr("-o"))));
  EXPECT_THAT(RunGlint({"sdf", "a.ply", "b.ply", "-o", "c.vdb"}).err, HasSubstr("not expected: b.ply"));
  EXPECT_EQ(RunGlint({"run"}).exit_code, 2);
  EXPECT_EQ(RunGlint({"run", "project"}).exit_code, 2);
  EXPECT_EQ(RunGlint({"synth", "sphere", "-o", Path("s"), "--size", "big"}).exit_code, 2);
  EXPECT_EQ(RunGlint({"synth", "sphere", "-o", Path("s"), "--views", "many"}).exit_code, 2);
  const ProgramResult result = RunGlint({"synth", "cube", "-o", Path("s"), "--views", "1"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("scene = cube: must be one of sphere"), HasSubstr("views = 1: must lie in")));
  EXPECT_FALSE(std::filesystem::exists(Path("s")));
}

TEST_F(Commands, ConfigPrintsTheDefaultsAndCompletesAFile) {
  EXPECT_EQ(RunGlint({"config"}).out, ReadText(GLINT_SOURCE_DIR "/configs/default.yaml"));
  Write("c.yaml", "refine:\n  levels: 2\n");
  const ProgramResult result = RunGlint({"config", "--config", Path("c.yaml"), "--set", "refine.max_iterations=7"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("  levels: 2\n"), HasSubstr("  max_iterations: 7\n")));
}

TEST_F(Commands, ConfigErrorsNameFileLineAndNearestKey) {
  Write("c.yaml", "refine:\n  leveIs: 2\n  voxel_rel: 3\n");
  const ProgramResult result = RunGlint({"config", "--config", Path("c.yaml"), "--set", "detect.saturation=x"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("c.yaml:2: refine.leveIs: unknown option; the nearest is refine.levels"),
                                HasSubstr("c.yaml:3: refine.voxel_rel = 3: must lie in"),
                                HasSubstr("--set: detect.saturation: expected a number, found \"x\"")));
}

TEST_F(Commands, MeshToFieldAndBack) {
  Write("cube.off", kCube);
  EXPECT_EQ(RunGlint({"sdf", Path("cube.off"), "-o", Path("cube.vdb"), "--resolution", "40", "--band", "5"}).exit_code,
            0);
  const ProgramResult inspected = RunGlint({"inspect", Path("cube.vdb")});
  EXPECT_THAT(inspected.out, AllOf(HasSubstr("voxel size   0.025"), HasSubstr("5 voxels to either side")));
  EXPECT_EQ(RunGlint({"mesh", Path("cube.vdb"), "-o", Path("grown.ply"), "--iso", "0.1"}).exit_code, 0);
  const ProgramResult grown = RunGlint({"inspect", Path("grown.ply")});
  EXPECT_THAT(grown.out, AllOf(HasSubstr("closed       yes"), HasSubstr("genus        0"), HasSubstr("with normals")));
  // Every point of the offset surface lies at its level from the cube.
  const ProgramResult compared = RunGlint({"compare", Path("grown.ply"), Path("cube.off"), "--json"});
  const auto json = nlohmann::json::parse(compared.out);
  const double diagonal = json["reference_diagonal"];
  EXPECT_NEAR(json["candidates"][0]["accuracy_rel"]["mean"].get<double>() * diagonal, 0.1, 0.003);
}

TEST_F(Commands, PicturesOfFieldsAndMeshes) {
  Write("cube.off", kCube);
  ASSERT_EQ(RunGlint({"sdf", Path("cube.off"), "-o", Path("cube.vdb"), "--resolution", "30"}).exit_code, 0);
  for (const char* file : {"cube.vdb", "cube.off"}) {
    const ProgramResult result =
        RunGlint({"render", Path(file), "-o", Path("a.png"), "--width", "64", "--height", "48"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(ReadText(Path("a.png")).substr(1, 3), "PNG");
  }
  EXPECT_EQ(RunGlint({"render", Path("cube.vdb"), "-o", Path("b.png"), "--width", "64", "--iso", "0.05"}).exit_code, 0);
  EXPECT_EQ(RunGlint({"render", Path("cube.vdb"), "-o", Path("c.png"), "--iso", "0.5"}).exit_code, 2);
  EXPECT_EQ(RunGlint({"render", Path("cube.vdb"), "-o", Path("c.png"), "--iso", "nan"}).exit_code, 2);
  EXPECT_EQ(RunGlint({"render", Path("cube.vdb"), "-o", Path("c.png"), "--direction", "0", "0", "0"}).exit_code, 2);
  EXPECT_EQ(RunGlint({"render", Path("cube.vdb"), "-o", Path("c.jpg")}).exit_code, 2);
  EXPECT_EQ(RunGlint({"render", Path("none.vdb"), "-o", Path("c.png")}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(Path("c.png")));
}

TEST_F(Commands, FieldsAndMeshesThatAreNone) {
  Write("cube.off", kCube);
  Write("noise.vdb", "this is no grid");
  EXPECT_EQ(RunGlint({"sdf", Path("none.ply"), "-o", Path("x.vdb")}).exit_code, 2);
  EXPECT_EQ(RunGlint({"mesh", Path("noise.vdb"), "-o", Path("x.ply")}).exit_code, 2);
  EXPECT_EQ(RunGlint({"sdf", Path("cube.off"), "-o", Path("x.vdb"), "--band", "-1"}).exit_code, 2);
  const ProgramResult huge = RunGlint({"sdf", Path("cube.off"), "-o", Path("x.vdb"), "--resolution", "40000"});
  EXPECT_EQ(huge.exit_code, 2);
  EXPECT_THAT(huge.err, HasSubstr("GB"));
  EXPECT_FALSE(std::filesystem::exists(Path("x.vdb")));
}

TEST_F(Commands, CompareOfAMeshWithItselfIsZero) {
  Write("cube.off", kCube);
  const ProgramResult result = RunGlint({"compare", Path("cube.off"), Path("cube.off"), "--json"});
  EXPECT_EQ(result.exit_code, 0);
  const auto candidate = nlohmann::json::parse(result.out)["candidates"][0];
  EXPECT_LT(candidate["accuracy_rel"]["max"], 1e-9);
  EXPECT_LT(candidate["chamfer_rel"], 1e-9);
  EXPECT_LT(candidate["normal_deg"]["max"], 1e-3);
  EXPECT_EQ(candidate["f_scores"][0]["f"], 1);
  EXPECT_THAT(RunGlint({"compare", Path("cube.off"), Path("cube.off")}).out, HasSubstr("F-score at 0.5 %"));
}

TEST_F(Commands, CompareSaysWhatCannotBeCompared) {
  Write("cube.off", kCube);
  Write("far.off", "OFF\n3 1 0\n70 0 0\n90 0 0\n70 30 0\n3 0 1 2\n");
  EXPECT_THAT(RunGlint({"compare", Path("far.off"), Path("cube.off")}).err, HasSubstr("are they in one frame?"));
  EXPECT_THAT(RunGlint({"compare", Path("cube.off"), Path("cube.off")}).err, Not(HasSubstr("frame")));
  for (const char* line : {"0 0 0\n1 0 0\n2 0 0\n", "1 1 1\n1 1 1\n1 1 1\n"}) {
    Write("line.off", std::string("OFF\n3 1 0\n") + line + "3 0 1 2\n");
    for (const auto& [mesh, reference] : {std::pair("line.off", "cube.off"), std::pair("cube.off", "line.off")}) {
      const ProgramResult result = RunGlint({"compare", Path(mesh), Path(reference)});
      EXPECT_EQ(result.exit_code, 2);
      EXPECT_THAT(result.err, HasSubstr("line.off: the mesh has no extent"));
    }
  }
}

TEST_F(Commands, CompareThroughASimilarity) {
  Write("cube.off", kCube);
  // A quarter turn about z, doubled and shifted: x' = 1 - 2 y, y' = 2 x, z' = 2 z.
  Write("sim.json", R"({"scale": 2, "R": [[0,-1,0],[1,0,0],[0,0,1]], "t": [1, 0, 0]})");
  std::string moved = kCube;
  const std::string vertices = "1 0 0\n1 2 0\n-1 2 0\n-1 0 0\n1 0 2\n1 2 2\n-1 2 2\n-1 0 2\n";
  moved.replace(moved.find("0 0 0\n"), moved.find("3 0 2 1") - moved.find("0 0 0\n"), vertices);
  moved.replace(0, moved.find("1 0 0\n"), "OFF\n8 12 0\n");
  Write("moved.off", moved);
  const ProgramResult result =
      RunGlint({"compare", Path("cube.off"), Path("moved.off"), "--transform", Path("sim.json"), "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_LT(nlohmann::json::parse(result.out)["candidates"][0]["chamfer_rel"], 1e-9);
  const ProgramResult aligned =
      RunGlint({"compare", Path("cube.off"), Path("moved.off"), "--align", "similarity", "--json"});
  EXPECT_EQ(aligned.exit_code, 0) << aligned.err;
  EXPECT_NEAR(nlohmann::json::parse(aligned.out)["reference_from_mesh"]["scale"], 2, 1e-3);
  EXPECT_LT(nlohmann::json::parse(aligned.out)["candidates"][0]["chamfer_rel"], 1e-4);
  EXPECT_EQ(RunGlint({"compare", Path("cube.off"), Path("moved.off"), "--align", "affine"}).exit_code, 2);
  Write("bad.json", R"({"scale": 2, "R": [[0,-1,0],[1,0,0]], "t": [1, 0, 0]})");
  EXPECT_EQ(RunGlint({"compare", Path("cube.off"), Path("moved.off"), "--transform", Path("bad.json")}).exit_code, 2);
  EXPECT_EQ(RunGlint({"compare", Path("cube.off"), Path("cube.off"), "--region", "gloss"}).exit_code, 2);
  EXPECT_EQ(RunGlint({"compare", Path("cube.off"), Path("cube.off"), "--project", "x"}).exit_code, 2);
}

TEST_F(Commands, SynthDetectInspect) {
  const ProgramResult synth =
      RunGlint({"synth", "sphere", "-o", Path("s"), "--views", "8", "--size", "160x120", "--seed", "3", "-q"});
  ASSERT_EQ(synth.exit_code, 0) << synth.err;
  EXPECT_EQ(synth.err, "");
  EXPECT_THAT(RunGlint({"inspect", Path("s")}).out,
              AllOf(HasSubstr("views        8"), HasSubstr("PINHOLE 160x120"), HasSubstr("8 of 8 found")));
  ASSERT_EQ(RunGlint({"detect", Path("s"), "-o", Path("m")}).exit_code, 0);
  for (const char* name : {"view_000.jpg.png", "view_003.jpg.png"})
    EXPECT_TRUE(std::filesystem::exists(folder_ / "m" / name)) << name;
}

TEST_F(Commands, InspectSaysWhatIsWrong) {
  std::string open = kCube;
  open.replace(open.find("8 12 0"), 6, "8 11 0");
  open.resize(open.rfind("3 3 4 7"));
  Write("open.off", open);
  const ProgramResult result = RunGlint({"inspect", Path("open.off")});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("closed       no"), HasSubstr("3 boundary edges")));
  EXPECT_EQ(RunGlint({"inspect", Path("nothing")}).exit_code, 2);
}

}  // namespace
}  // namespace glint
