#include "core/error.h"

#include <gmock/gmock.h>

#include "core/check.h"
#include "core/progress.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

TEST(InputError, MessageNamesPathRecordAndWhat) {
  const InputError error("a/cameras.bin", "camera 3", "expected a positive focal length, found -1");
  EXPECT_STREQ(error.what(), "a/cameras.bin: camera 3: expected a positive focal length, found -1");
  EXPECT_EQ(error.path(), "a/cameras.bin");
  EXPECT_EQ(error.record(), "camera 3");
}

TEST(InputError, EmptyPartsAreLeftOut) {
  EXPECT_STREQ(InputError("", "", "what").what(), "what");
  EXPECT_STREQ(InputError("file", "", "what").what(), "file: what");
}

TEST(Check, FailurePrintsTheOperands) {
  const int three = 3;
  try {
    GLINT_CHECK_LT(three, 2);
    FAIL();
  } catch (const std::logic_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("three < 2 (3 against 2)"));
  }
  EXPECT_THROW(GLINT_CHECK(three == 4), std::logic_error);
  GLINT_CHECK_EQ(three, 3);
}

class CancelledProgress : public Progress {
 public:
  bool Cancelled() const override { return true; }
};

TEST(Progress, CancellationIsThrownBetweenUnitsOfWork) {
  EXPECT_THROW(CancelledProgress().ThrowIfCancelled(), CancelledError);
  EXPECT_NO_THROW(Progress::Silent().ThrowIfCancelled());
}

}  // namespace
}  // namespace glint
