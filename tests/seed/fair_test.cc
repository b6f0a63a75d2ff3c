#include "seed/fair.h"

#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace glint {
namespace {

// A surface that fairing has shrunk to nearly nothing, and points far off it: it must not be torn to their size, for it
// is remeshed by its own, which used to fill the memory (two views, `odd_projects`).
TEST(FairThroughPoints, APointlikeSurfaceDoesNotFlyApart) {
  TriangleMesh mote = testing::Icosphere(1);
  std::vector<Attachment> attachments;
  for (const Eigen::Vector3d& x : mote.vertices) attachments.push_back({x, 0.01});
  for (Eigen::Vector3d& x : mote.vertices) x *= 0.02;
  const FairResult fair = FairThroughPoints(mote, attachments, {}, {});
  EXPECT_LT(SurfaceArea(fair.mesh), 4 * SurfaceArea(mote));
  EXPECT_EQ(fair.trust.size(), attachments.size());
}

}  // namespace
}  // namespace glint
