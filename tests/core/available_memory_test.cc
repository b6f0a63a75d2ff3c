#include "core/available_memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fstream>
#include <string>

namespace glint {
namespace {

namespace fs = std::filesystem;

class GroupMemory : public ::testing::Test {
 protected:
  GroupMemory() { fs::remove_all(root_); }
  ~GroupMemory() override { fs::remove_all(root_); }
  void Write(const std::string& name, const std::string& text) const {
    fs::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << text;
  }
  uint64_t Left() const { return internal::GroupMemoryLeft(root_ / "membership", root_ / "sys"); }
  fs::path root_ = fs::path(::testing::TempDir()) / "glint_group_memory_test";
};

TEST_F(GroupMemory, NoGroupIsNoLimit) { EXPECT_EQ(Left(), ~uint64_t{0}); }

TEST_F(GroupMemory, Version2) {
  Write("membership", "0::/outer/inner\n");
  Write("sys/outer/inner/memory.max", "max\n");
  Write("sys/outer/inner/memory.current", "300\n");
  EXPECT_EQ(Left(), ~uint64_t{0});
  Write("sys/outer/memory.max", "5000\n");
  Write("sys/outer/memory.current", "4000\n");
  EXPECT_EQ(Left(), 1000u);
  Write("sys/outer/memory.stat", "anon 3000\ninactive_file 500\n");
  EXPECT_EQ(Left(), 1500u) << "cached files are given up on demand";
  Write("sys/outer/inner/memory.max", "350\n");
  EXPECT_EQ(Left(), 50u) << "the narrowest of the groups counts";
  Write("sys/outer/inner/memory.current", "400\n");
  EXPECT_EQ(Left(), 0u);
}

TEST_F(GroupMemory, Version1) {
  Write("membership", "9:name=systemd:/x\n4:cpu,memory:/group\n0::/\n");
  Write("sys/memory/group/memory.limit_in_bytes", "9223372036854771712\n");
  Write("sys/memory/group/memory.usage_in_bytes", "100\n");
  EXPECT_EQ(Left(), ~uint64_t{0}) << "version 1 says no limit as a very large number";
  Write("sys/memory/group/memory.limit_in_bytes", "1000\n");
  EXPECT_EQ(Left(), 900u);
}

TEST_F(GroupMemory, AContainerSeesItsOwnFilesAtTheRoot) {
  Write("membership", "0::/not/visible/here\n");
  Write("sys/memory.max", "1000\n");
  Write("sys/memory.current", "100\n");
  EXPECT_EQ(Left(), 900u);
}

TEST(AvailableMemory, HeedsTheAddressSpaceLimit) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs the address space";
#endif
  const uint64_t before = AvailableMemory();
  EXPECT_GT(before, uint64_t{1} << 20);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &limit), 0);
  rlimit small = limit;
  small.rlim_cur = uint64_t{64} << 20;  // less than what the program has already taken
  ASSERT_EQ(setrlimit(RLIMIT_AS, &small), 0);
  const uint64_t left = AvailableMemory();
  ASSERT_EQ(setrlimit(RLIMIT_AS, &limit), 0);
  EXPECT_LT(left, uint64_t{64} << 20);
}

}  // namespace
}  // namespace glint
