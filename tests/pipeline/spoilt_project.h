// A small project that is rendered once, and that every test spoils in its own way.
#pragma once

#include "colmap/model.h"
#include "tests/pipeline/program.h"
#include "tests/support/shared_folder.h"

namespace glint {

class SpoiltProject : public ProgramTest {
 protected:
  static constexpr size_t kViews = 8;

  SpoiltProject() { Restore(); }

  void Restore() const {
    namespace fs = std::filesystem;
    fs::remove_all(folder_ / "p");
    fs::copy(testing_support::SharedFolder("spoilt_project", Make), folder_ / "p", fs::copy_options::recursive);
  }

  std::filesystem::path ModelFolder() const { return folder_ / "p/sparse/0"; }

  template <class Change>
  void ChangeModel(const Change& change) const {
    Model model = ReadModel(ModelFolder());
    change(model);
    WriteModel(model, ModelFolder());
  }

 private:
  static void Make(const std::filesystem::path& folder) {
    const ProgramResult result = RunGlint(
        {"synth", "sphere", "-o", folder.string(), "--views", std::to_string(kViews), "--size", "160x120", "-q"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
};

}  // namespace glint
