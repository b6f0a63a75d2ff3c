#include "pipeline/run_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "tests/pipeline/program.h"

namespace glint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class Listener : public Progress {
 public:
  void Begin(std::string_view what, size_t total) override {
    heard.push_back("begin " + std::string(what) + " " + std::to_string(total));
  }
  void Advance(size_t steps) override { heard.push_back("advance " + std::to_string(steps)); }
  void Info(std::string_view message) override { heard.push_back("info " + std::string(message)); }
  void Warn(std::string_view message) override { heard.push_back("warn " + std::string(message)); }
  bool Cancelled() const override { return cancelled; }

  std::vector<std::string> heard;
  bool cancelled = false;
};

class RunLogTest : public ProgramTest {
 protected:
  Listener listener_;
  RunLog log_{listener_};
};

TEST_F(RunLogTest, HandsEverythingOn) {
  log_.Begin("detect", 5);
  log_.Advance(2);
  log_.Info("said");
  log_.Warn("odd");
  log_.Finish();
  EXPECT_THAT(listener_.heard, ElementsAre("begin detect 5", "advance 2", "info said", "warn odd", "begin  0"));
  EXPECT_THAT(log_.Warnings(), ElementsAre("odd"));
}

TEST_F(RunLogTest, TheListenerDecidesWhetherToStop) {
  EXPECT_NO_THROW(log_.ThrowIfCancelled());
  listener_.cancelled = true;
  EXPECT_THROW(log_.ThrowIfCancelled(), CancelledError);
}

TEST_F(RunLogTest, WritesWhatIsSaidFromThenOn) {
  log_.Info("too early");
  log_.WriteTo(Path("log.txt"));
  log_.Begin("detect", 5);
  log_.Begin("gate", 0);
  log_.Warn("odd");
  log_.Failed("no result");
  const std::string text = ReadText(Path("log.txt"));
  EXPECT_THAT(text, Not(HasSubstr("too early")));
  EXPECT_THAT(text, HasSubstr("detect (5): 0.0 s"));
  EXPECT_THAT(text, HasSubstr(" W odd"));
  EXPECT_THAT(text, HasSubstr(" E no result"));
}

TEST_F(RunLogTest, AFileThatCannotBeOpenedIsAnInputError) {
  std::filesystem::create_directories(Path("folder"));
  EXPECT_THROW(log_.WriteTo(Path("folder")), InputError);
}

}  // namespace
}  // namespace glint
