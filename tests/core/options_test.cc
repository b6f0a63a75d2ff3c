#include "core/options.h"

#include <gmock/gmock.h>

#include <cmath>

namespace glint {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

struct InnerOptions {
  double width_rel = 0.5;
  std::string kind = "round";
  std::vector<double> weights = {1, 2};
  void Visit(OptionVisitor& v) {
    v.Field({.name = "width_rel", .help = "Width.", .min = 0.1, .max = 1}, width_rel);
    v.Field({.name = "kind", .help = "Kind.", .choices = {"round", "square"}}, kind);
    v.Field({.name = "weights", .help = "Weights.", .min = 0}, weights);
  }
};

struct OuterOptions {
  InnerOptions inner;
  int count = 3;
  bool on = true;
  void Visit(OptionVisitor& v) {
    VisitSection(v, "inner", "Inner things.", inner);
    v.Field({.name = "count", .help = "Count.", .max = 10}, count);
    v.Field({.name = "on", .help = "On."}, on);
  }
};

TEST(Options, DefaultsHaveNoViolations) { EXPECT_THAT(Violations(OuterOptions()), IsEmpty()); }

TEST(Options, EveryViolationIsListedWithPathValueAndConstraint) {
  OuterOptions options;
  options.inner.width_rel = 2;
  options.inner.kind = "oval";
  options.inner.weights = {1, -1};
  options.count = 11;
  EXPECT_THAT(
      Violations(options),
      ElementsAre("inner.width_rel = 2: must lie in [0.1, 1]", "inner.kind = oval: must be one of round, square",
                  "inner.weights = -1: must be at least 0", "count = 11: must be at most 10"));
}

TEST(Options, NumbersThatAreNotFiniteAreViolations) {
  OuterOptions options;
  options.inner.width_rel = std::nan("");
  options.inner.weights = {INFINITY};
  EXPECT_EQ(Violations(options).size(), 2u);
}

}  // namespace
}  // namespace glint
