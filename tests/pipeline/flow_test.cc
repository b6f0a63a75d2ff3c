// What a run shows while it works, for people and for programs; and many runs in one go. Through the program.
#include <gmock/gmock.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "pipeline/run.h"
#include "tests/pipeline/small_scene.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

class FlowTest : public SmallScene {
 protected:
  static std::vector<Json> Events(const std::string& text) {
    std::vector<Json> events;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) events.push_back(Json::parse(line));
    return events;
  }
};

TEST_F(FlowTest, EventsForOtherPrograms) {
  const ProgramResult result = Run("out", {"--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const std::vector<Json> events = Events(result.out);
  EXPECT_EQ(events.front()["event"], "begin");
  EXPECT_EQ(events.back()["event"], "end");
  EXPECT_EQ(events.back()["outcome"], "done");
  EXPECT_EQ(events.back()["mesh"], Path("out/mesh.ply"));
  EXPECT_GT(events.back()["faces"], 100);
  std::vector<std::string> begun, ended;
  for (const Json& event : events) {
    if (event["event"] == "stage") begun.push_back(event["stage"]);
    if (event["event"] == "stage_end") ended.push_back(event["stage"]);
    if (event["event"] == "progress" && event.contains("total")) {
      EXPECT_LE(event["done"], event["total"]) << event;
      EXPECT_EQ(event["stage"], begun.back());
    }
  }
  // All but the first: there is a project, nothing is made from photographs.
  EXPECT_THAT(begun, ElementsAreArray(kRunStageNames.begin() + 1, kRunStageNames.end()));
  EXPECT_EQ(ended, begun);

  EXPECT_EQ(Events(Run("out", {"--json"}).out).back()["outcome"], "nothing to do");
  const ProgramResult bad = Run("out", {"--json", "--set", "refine.levels=0"});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_EQ(Events(bad.out).back()["exit_code"], 2);
  EXPECT_THAT(Events(bad.out).back()["message"].get<std::string>(), HasSubstr("refine.levels = 0"));
}

// What the program draws on a terminal of so many columns.
std::string OnTerminal(std::vector<std::string> arguments, unsigned short columns) {
  winsize size = {24, columns, 0, 0};
  int master = -1;
  const pid_t child = ::forkpty(&master, nullptr, nullptr, &size);
  if (child == 0) {
    std::vector<char*> argv = {const_cast<char*>("glint")};
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    ::execv(GLINT_PROGRAM, argv.data());
    ::_exit(127);
  }
  std::string drawn;
  std::array<char, 4096> buffer;
  for (ssize_t n; (n = ::read(master, buffer.data(), buffer.size())) > 0;)
    drawn.append(buffer.data(), static_cast<size_t>(n));
  ::close(master);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0) << drawn;
  return drawn;
}

TEST_F(FlowTest, BarsOnATerminalPlainLinesInAPipeNothingIfQuiet) {
  const ProgramResult piped = Run("out", {"--until", "detect"});
  EXPECT_THAT(piped.err, AllOf(HasSubstr("detect highlights (8): "), Not(HasSubstr("\r")), Not(HasSubstr("\x1b"))));
  EXPECT_EQ(Run("out", {"--until", "detect", "--force", "-q"}).err, "");

  const std::string drawn = OnTerminal({"run", Path("p"), "-o", Path("tty"), "--mesh", Path("ball.off"), "--lights",
                                        Path("p/truth/lights.json"), "--config", Path("c.yaml")},
                                       50);
  EXPECT_THAT(drawn, AllOf(HasSubstr("[2/6 detect] detect highlights [##"), HasSubstr("[5/6 refine]")));
  std::istringstream pieces(drawn);
  for (std::string piece; std::getline(pieces, piece, '\r');) {
    const size_t shown = piece.starts_with("\x1b[K[") ? piece.size() - 3 : 0;
    EXPECT_LE(shown, 49u) << "a bar that wraps cannot be drawn over: " << piece;
  }
}

class BatchTest : public FlowTest {};

TEST_F(BatchTest, AProjectThatFailsStopsNoOther) {
  Write("light.yaml", "output:\n  overlays: false\n");
  Write("batch.yaml",
        "out: results\nlights: p/truth/lights.json\nset: {refine.voxel_rel: 0.03, refine.levels: 1}\nprojects:\n"
        "  - {project: p, name: first, mesh: ball.off}\n"
        "  - nowhere\n"
        "  - {project: p, name: wrong, set: {refine.levels: 0}}\n"
        "  - {project: p, name: dark, mesh: ball.off, set: {detect.min_strength: 1}}\n"
        "  - {project: p, name: last, mesh: ball.off, config: light.yaml}\n");
  const ProgramResult result = RunGlint({"run", "--batch", Path("batch.yaml")});
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("2 of 5 done"), HasSubstr("refine.levels = 0"),
                                HasSubstr("no highlights found"), HasSubstr("nowhere")));
  for (const char* name : {"first", "last"}) EXPECT_TRUE(fs::exists(folder_ / "results" / name / "mesh.ply")) << name;
  EXPECT_TRUE(fs::exists(folder_ / "results/first/highlights"));
  EXPECT_FALSE(fs::exists(folder_ / "results/last/highlights")) << "its own configuration";

  // Again: what is done stays done, for programs this time.
  const ProgramResult again = RunGlint({"run", "--batch", Path("batch.yaml"), "--json"});
  EXPECT_EQ(again.exit_code, 2);
  const std::vector<Json> events = Events(again.out);
  const Json& projects = events.back()["projects"];
  std::vector<int> codes;
  for (const Json& project : projects) codes.push_back(project["exit_code"]);
  EXPECT_THAT(codes, ElementsAre(0, 2, 2, 3, 0));
  EXPECT_EQ(projects[0]["outcome"], "nothing to do");
  EXPECT_EQ(events.front()["name"], "first");
}

TEST_F(BatchTest, EveryProblemOfTheFileIsSaidBeforeAnythingRuns) {
  Write("batch.yaml",
        "outt: x\nprojects:\n  - {project: p, nme: a}\n  - {project: p}\n  - {name: b}\n"
        "  - {project: p, name: ../b, set: 3}\n");
  const ProgramResult result = RunGlint({"run", "--batch", Path("batch.yaml")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(
      result.err,
      AllOf(HasSubstr("batch.yaml:1: unknown key \"outt\""), HasSubstr("batch.yaml:3: unknown key \"nme\""),
            HasSubstr("batch.yaml:4: p and p would both write into"), HasSubstr("batch.yaml:5: expected a project"),
            HasSubstr("batch.yaml:6: name"), HasSubstr("batch.yaml:6: set")));
  EXPECT_FALSE(fs::exists(folder_ / "glint"));
  for (const char* text :
       {"", "projects: []\n", "- p\n", "projects: [", "projects: {a: b}\n", "projects: [[p]]\n", "projects: [/]\n"}) {
    Write("batch.yaml", text);
    EXPECT_EQ(RunGlint({"run", "--batch", Path("batch.yaml")}).exit_code, 2) << text;
  }
  EXPECT_EQ(RunGlint({"run", "--batch", Path("none.yaml")}).exit_code, 2);
  EXPECT_EQ(RunGlint({"run", Path("p"), "--batch", Path("batch.yaml")}).exit_code, 2) << "one or many";
  EXPECT_EQ(RunGlint({"run", Path("p")}).exit_code, 2) << "where to?";
}

TEST_F(FlowTest, BashCompletes) {
  // What bash offers for a command line whose last word is being typed.
  Write("glint.bash", RunGlint({"completion", "bash"}).out);
  const auto offers = [&](const std::string& words) {
    Write("ask.sh", "source '" + Path("glint.bash") + "'\nCOMP_WORDS=(glint " + words +
                        ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_glint\necho \"${COMPREPLY[*]}\"\n");
    EXPECT_EQ(std::system(("bash '" + Path("ask.sh") + "' > '" + Path("offers") + "'").c_str()), 0) << words;
    return ReadText(folder_ / "offers");
  };
  EXPECT_EQ(offers("ru"), "run\n");
  EXPECT_EQ(offers("run --from ''"), "photos seed detect lights gate refine report\n");
  EXPECT_EQ(offers("run --from g"), "gate\n");
  EXPECT_EQ(offers("run --set refine.vox"), "refine.voxel_rel=\n");
  EXPECT_THAT(offers("run --f"), AllOf(HasSubstr("--from"), HasSubstr("--force")));
  EXPECT_EQ(offers("synth --light-kind fl"), "flash\n");
  EXPECT_EQ(offers("completion z"), "zsh\n");
  EXPECT_EQ(offers("synth h"), "hood\n");
  EXPECT_EQ(offers("run --from = g"), "gate\n") << "bash takes --from=g apart";
  EXPECT_EQ(offers("run --set refine.method ="), "\n") << "no files where a value is typed";
  EXPECT_EQ(offers("run '" + Path("c.y") + "'"), Path("c.yaml") + "\n");
  EXPECT_EQ(offers("run --threads ''"), "\n") << "a number is nothing to offer words for";
}

TEST_F(FlowTest, OtherShellsTakeTheirScripts) {
  for (const char* shell : {"zsh", "fish"}) {
    const ProgramResult script = RunGlint({"completion", shell});
    EXPECT_EQ(script.exit_code, 0);
    Write(shell, script.out);
    if (std::system((std::string("command -v ") + shell + " > /dev/null").c_str()) != 0) continue;
    EXPECT_EQ(std::system((std::string(shell) + " -n '" + Path(shell) + "'").c_str()), 0) << shell;
  }
  if (std::system("command -v fish > /dev/null") == 0) {
    const std::map<std::string, std::string> offers{
        {"run --from g", "gate"}, {"synth h", "hood"}, {"--ver", "--version"}};
    for (const auto& [words, offer] : offers) {
      const std::string ask =
          "fish -c \"source '" + Path("fish") + "'; complete -C 'glint " + words + "'\" > '" + Path("offers") + "'";
      EXPECT_EQ(std::system(ask.c_str()), 0);
      EXPECT_THAT(ReadText(folder_ / "offers"), testing::StartsWith(offer)) << words;
    }
  }
  EXPECT_EQ(RunGlint({"completion", "tcsh"}).exit_code, 2);
}

}  // namespace
}  // namespace glint
