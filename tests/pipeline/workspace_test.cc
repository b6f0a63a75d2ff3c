#include "pipeline/workspace.h"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "core/error.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

class WorkspaceTest : public ::testing::Test {
 protected:
  void TearDown() override { fs::remove_all(root_); }
  fs::path root_ = fs::path(::testing::TempDir()) / "glint_workspace_test";
};

TEST_F(WorkspaceTest, OneRunAtATime) {
  {
    const Workspace first(root_ / "out");
    EXPECT_TRUE(fs::is_directory(root_ / "out"));
    EXPECT_THROW(Workspace(root_ / "out"), InputError);
  }
  EXPECT_NO_THROW(Workspace(root_ / "out"));
  EXPECT_TRUE(fs::is_empty(root_ / "out")) << "the lock leaves nothing behind";
}

TEST_F(WorkspaceTest, TemporariesOfAKilledRunGoAndNothingElse) {
  fs::create_directories(root_ / "highlights/sub");
  fs::create_directories(root_ / "highlight_masks");
  for (const char* name :
       {".tmp-12-0.ply", "highlights/sub/.tmp-12-3.png", "highlight_masks/.tmp-12-4.png", ".tmp-notes.txt", "mine.txt"})
    std::ofstream(root_ / name) << "x";
  const Workspace workspace(root_);
  EXPECT_FALSE(fs::exists(root_ / ".tmp-12-0.ply"));
  EXPECT_FALSE(fs::exists(root_ / "highlights/sub/.tmp-12-3.png"));
  EXPECT_FALSE(fs::exists(root_ / "highlight_masks/.tmp-12-4.png"));
  EXPECT_TRUE(fs::exists(root_ / ".tmp-notes.txt"));
  EXPECT_TRUE(fs::exists(root_ / "mine.txt"));
}

TEST_F(WorkspaceTest, AFileInTheWayIsNamed) {
  fs::create_directories(root_);
  std::ofstream(root_ / "out") << "x";
  EXPECT_THROW(Workspace(root_ / "out"), InputError);
  EXPECT_THROW(Workspace(root_ / "out/deeper"), InputError);
}

std::string Text(const fs::path& file) {
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

TEST_F(WorkspaceTest, APublicationIsAllOrNothingUntilItIsPublished) {
  const Workspace out(root_);
  for (const fs::path& file : {out.Mesh(), out.Lights(), out.Report()}) std::ofstream(file) << "old";
  {
    Publication unfinished(out);
    const fs::path staged = unfinished.For(out.Mesh());
    EXPECT_EQ(staged.extension(), ".ply") << "writers go by the extension";
    fs::create_directories(staged.parent_path());
    std::ofstream(staged) << "half";
  }
  EXPECT_EQ(Text(out.Mesh()), "old");
  Publication files(out);
  for (const fs::path& file : {out.Mesh(), out.Lights()}) {
    const fs::path staged = files.For(file);
    fs::create_directories(staged.parent_path());
    std::ofstream(staged) << "new";
  }
  files.Remove(out.Report());
  files.Publish();
  EXPECT_EQ(Text(out.Mesh()), "new");
  EXPECT_EQ(Text(out.Lights()), "new");
  EXPECT_FALSE(fs::exists(out.Report()));
  EXPECT_FALSE(fs::exists(out.StagedFiles()));
}

TEST_F(WorkspaceTest, EarlierResultsAreSetAsideButNotInputs) {
  const Workspace out(root_);
  EXPECT_FALSE(out.SetEarlierResultsAside({}));
  for (const fs::path& file : {out.Mesh(), out.Lights(), out.Report()}) std::ofstream(file) << "old";
  EXPECT_TRUE(out.SetEarlierResultsAside({out.Lights()}));
  EXPECT_EQ(Text(root_ / "earlier/mesh.ply"), "old");
  EXPECT_EQ(Text(root_ / "earlier/report.json"), "old");
  EXPECT_FALSE(fs::exists(out.Mesh()));
  EXPECT_TRUE(fs::exists(out.Lights()));
}

TEST(PathForImage, StaysInTheFolder) {
  EXPECT_EQ(PathForImage("out", "a/b.jpg", ".png"), fs::path("out/a/b.jpg.png"));
  EXPECT_EQ(PathForImage("out", "ä ö.jpg", ".png"), fs::path("out/ä ö.jpg.png"));
  for (const char* name : {"../a.jpg", "a/../../b.jpg", "/etc/passwd", "", "a/"})
    EXPECT_THROW(PathForImage("out", name, ".png"), InputError) << name;
}

}  // namespace
}  // namespace glint
