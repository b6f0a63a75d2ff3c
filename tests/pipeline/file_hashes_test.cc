#include "pipeline/file_hashes.h"

#include <gmock/gmock.h>

#include <chrono>
#include <cstdlib>
#include <fstream>

#include "core/error.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

class FileHashesTest : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(root_); }
  void TearDown() override { fs::remove_all(root_); }
  void Write(const std::string& name, const std::string& text) const { std::ofstream(root_ / name) << text; }
  // As if the file had last been changed this many seconds ago.
  void SetAge(const std::string& name, int seconds) const {
    fs::last_write_time(root_ / name, fs::file_time_type::clock::now() - std::chrono::seconds(seconds));
  }
  fs::path root_ = fs::path(::testing::TempDir()) / "glint_file_hashes_test";
  fs::path memory_ = root_ / "hashes.json";
};

TEST_F(FileHashesTest, ContentsDecide) {
  FileHashes hashes(memory_);
  Write("a", "one");
  Write("b", "one");
  Write("c", "two");
  EXPECT_EQ(hashes.Of(root_ / "a"), hashes.Of(root_ / "b"));
  EXPECT_NE(hashes.Of(root_ / "a"), hashes.Of(root_ / "c"));
  EXPECT_EQ(hashes.Of(root_ / "none"), "");
  EXPECT_EQ(hashes.Of(root_), "") << "a folder is no file";
  EXPECT_EQ(hashes.Of(root_ / "a").size(), 32u);
}

TEST_F(FileHashesTest, AChangeRightAfterReadingIsSeen) {
  FileHashes hashes(memory_);
  Write("a", "one");
  const std::string before = hashes.Of(root_ / "a");
  Write("a", "two");
  EXPECT_NE(hashes.Of(root_ / "a"), before);
}

TEST_F(FileHashesTest, RemembersWhatHasNotBeenTouched) {
  Write("a", "one");
  SetAge("a", 60);
  std::string before;
  {
    FileHashes hashes(memory_);
    before = hashes.Of(root_ / "a");
    hashes.Save();
  }
  // The memory is what answers: contents changed behind its back, with size and time as they were, are not looked at.
  const auto time = fs::last_write_time(root_ / "a");
  Write("a", "two");
  fs::last_write_time(root_ / "a", time);
  EXPECT_EQ(FileHashes(memory_).Of(root_ / "a"), before);
  SetAge("a", 30);
  EXPECT_NE(FileHashes(memory_).Of(root_ / "a"), before);
}

TEST_F(FileHashesTest, AnUnsoundMemoryOnlyCostsTime) {
  Write("a", "one");
  const std::string hash = FileHashes(memory_).Of(root_ / "a");
  for (const char* text : {"", "{", "[1]", "{\"/x\": [1, 2]}", "{\"/x\": [1, -2, \"y\", {}, 4]}",
                           "{\"/x\": [1, 2, 3, -9223372036854775808, \"\"]}"}) {
    Write("hashes.json", text);
    EXPECT_EQ(FileHashes(memory_).Of(root_ / "a"), hash) << text;
  }
}

TEST_F(FileHashesTest, AnyTimeOfChangeWillDo) {
  Write("a", "one");
  const std::string hash = FileHashes(memory_).Of(root_ / "a");
  // Not every file system keeps such a year; then it is a nearer one.
  for (const char* seconds : {"17000000000", "-17000000000"}) {
    const std::string command = std::string("touch -d @") + seconds + " '" + (root_ / "a").string() + "' 2> /dev/null";
    if (std::system(command.c_str()) == 0) {
      EXPECT_EQ(FileHashes(memory_).Of(root_ / "a"), hash) << seconds;
    }
  }
}

TEST_F(FileHashesTest, OfSeveralFilesNamesAndContentsCount) {
  FileHashes hashes(memory_);
  Write("a", "one");
  Write("b", "two");
  const std::string both = hashes.Of(root_, {"a", "b"});
  EXPECT_EQ(both, hashes.Of(root_, {"a", "b"}));
  EXPECT_NE(both, hashes.Of(root_, {"b", "a"}));
  fs::remove(root_ / "b");
  EXPECT_NE(both, hashes.Of(root_, {"a", "b"}));
}

TEST(BuildId, IsThereAndStays) {
  EXPECT_GE(BuildId().size(), 16u);
  EXPECT_EQ(BuildId(), BuildId());
  EXPECT_EQ(BuildId().find_first_not_of("0123456789abcdef"), std::string::npos);
}

}  // namespace
}  // namespace glint
