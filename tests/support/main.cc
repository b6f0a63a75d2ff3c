// The tests' main: every test program gets a temporary folder of its own, so that programs that run at the same time
// (ctest starts one for each test) never share a path. ::testing::TempDir(), std::filesystem::temp_directory_path()
// and the programs that tests start all follow it; the folder goes with the program.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>

int main(int argc, char** argv) {
  ::testing::InitGoogleMock(&argc, argv);
  std::string folder = (std::filesystem::temp_directory_path() / "glint_test_XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) {
    std::cerr << folder << ": cannot create a temporary folder\n";
    return 1;
  }
  ::setenv("TMPDIR", folder.c_str(), 1);
  ::setenv("TEST_TMPDIR", folder.c_str(), 1);
  const int result = RUN_ALL_TESTS();
  std::error_code ignored;  // what cannot be removed does not change what the tests found
  std::filesystem::remove_all(folder, ignored);
  return result;
}
