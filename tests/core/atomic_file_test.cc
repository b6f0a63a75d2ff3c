#include "core/atomic_file.h"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "core/error.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

std::string ReadAll(const fs::path& path) {
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

class AtomicFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("atomic_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  size_t NumFiles() const { return std::distance(fs::directory_iterator(folder_), fs::directory_iterator()); }
  fs::path folder_;
};

TEST_F(AtomicFile, WritesAndReplacesWholeFiles) {
  WriteFileAtomically(folder_ / "sub/a.txt", "one");
  EXPECT_EQ(ReadAll(folder_ / "sub/a.txt"), "one");
  WriteFileAtomically(folder_ / "sub/a.txt", [](std::ostream& out) { out << "two"; });
  EXPECT_EQ(ReadAll(folder_ / "sub/a.txt"), "two");
}

TEST_F(AtomicFile, AnExceptionWhileWritingKeepsTheOldFileAndLeavesNoOther) {
  WriteFileAtomically(folder_ / "a.txt", "old");
  EXPECT_THROW(WriteFileAtomically(folder_ / "a.txt",
                                   [](std::ostream& out) {
                                     out << "half";
                                     throw std::runtime_error("stop");
                                   }),
               std::runtime_error);
  EXPECT_EQ(ReadAll(folder_ / "a.txt"), "old");
  EXPECT_EQ(NumFiles(), 1u);
}

TEST_F(AtomicFile, LibrariesThatOpenByNameGetTheSameExtension) {
  WriteNamedFileAtomically(folder_ / "a.png", [&](const fs::path& temporary) {
    EXPECT_EQ(temporary.extension(), ".png");
    EXPECT_EQ(temporary.parent_path(), folder_);
    std::ofstream(temporary) << "image";
  });
  EXPECT_EQ(ReadAll(folder_ / "a.png"), "image");
  EXPECT_EQ(NumFiles(), 1u);
}

TEST_F(AtomicFile, AFolderInTheWayIsNamed) {
  fs::create_directories(folder_ / "a.txt");
  try {
    WriteFileAtomically(folder_ / "a.txt", "x");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.path(), (folder_ / "a.txt").string());
  }
}

}  // namespace
}  // namespace glint
