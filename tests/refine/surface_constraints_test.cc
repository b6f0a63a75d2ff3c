#include "refine/surface_constraints.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sdf/mesh_to_level_set.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

OrientedPoint OnSphere(double turned_deg) {
  OrientedPoint contact;
  contact.position = contact.bundle_position = Eigen::Vector3d::UnitX();
  const double turned = turned_deg * M_PI / 180;
  contact.normal = {std::cos(turned), std::sin(turned), 0};
  contact.sigma_normal = 0.005;
  contact.reach = 0.1;
  return contact;
}

// What the seed is no judge of is met as a whole; what would fold the surface is not.
TEST(SurfaceConstraints, TrustsNoNormalThatWouldFoldTheSurface) {
  const Band band(MeshToLevelSet(testing::Icosphere(4), 0.05));
  const std::vector<double> phi(band.phi().begin(), band.phi().end());
  const auto share = [&](double turned_deg, bool trust) {
    SurfaceConstraints constraints(band);
    constraints.AddContacts({OnSphere(turned_deg)}, 1);
    EXPECT_EQ(constraints.rows().size(), 3u);
    return constraints.RobustWeights(phi, trust)[0] / constraints.rows().weight[0];
  };
  EXPECT_EQ(share(30, true), 1);
  EXPECT_LT(share(30, false), 0.01);
  EXPECT_LT(share(70, true), 0.01);
  EXPECT_EQ(share(70, true), share(70, false));
}

}  // namespace
}  // namespace glint
