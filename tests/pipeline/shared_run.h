// One small project and one finished run of it, which several tests look at and leave as they are.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/pipeline/program.h"
#include "tests/support/shared_folder.h"

namespace glint {

class SharedRun : public ProgramTest {
 protected:
  static constexpr int kNumViews = 12;
  static constexpr double kVoxelRel = 0.03;

  static void SetUpTestSuite() { shared_ = testing_support::SharedFolder("shared_run", Make); }
  static void Make(const std::filesystem::path& folder) {
    shared_ = folder;
    const ProgramResult synth = RunGlint(
        {"synth", "ellipsoid", "-o", Project(), "--views", std::to_string(kNumViews), "--size", "240x180", "-q"});
    ASSERT_EQ(synth.exit_code, 0) << synth.err;
    const ProgramResult run = RunGlint(Arguments(Out().string(), {"--threads", "2"}));
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }

  static std::string Project() { return (shared_ / "p").string(); }
  static std::string Lights() { return (shared_ / "p/truth/lights.json").string(); }
  static std::filesystem::path Out() { return shared_ / "out"; }

  // A coarse seed and level set: the flow is what is tested, not the last digit.
  static std::vector<std::string> ArgumentsFor(const std::string& project, const std::string& out,
                                               const std::vector<std::string>& more, bool lights = true) {
    std::vector<std::string> arguments = {"run",   project,
                                          "-o",    out,
                                          "--set", fmt::format("refine.voxel_rel={}", kVoxelRel),
                                          "--set", "refine.levels=2",
                                          "--set", "seed.smooth.edge_rel=0.03"};
    if (lights) arguments.insert(arguments.end(), {"--lights", Lights()});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  static std::vector<std::string> Arguments(const std::string& out, const std::vector<std::string>& more,
                                            bool lights = true) {
    return ArgumentsFor(Project(), out, more, lights);
  }

  static inline std::filesystem::path shared_;
};

}  // namespace glint
