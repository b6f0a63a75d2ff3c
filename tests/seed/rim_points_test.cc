#include "seed/rim_points.h"

#include <gmock/gmock.h>

#include <cmath>

#include "simulated_scene.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

// Outlines of the unit sphere, `per_view` in every view: the circle in which rays from the eye touch it.
std::vector<OutlineSample> SphereOutline(const Scene& scene, int per_view, double interval = 0.02) {
  std::vector<OutlineSample> outline;
  for (size_t v = 0; v < scene.views.size(); ++v) {
    const Eigen::Vector3d eye = scene.views[v].Center(), axis = eye.normalized(), u = axis.unitOrthogonal(),
                          w = axis.cross(u);
    const double height = 1 / eye.norm(), radius = std::sqrt(1 - height * height);
    for (int i = 0; i < per_view; ++i) {
      const double a = 2 * M_PI * i / per_view;
      const Eigen::Vector3d x = height * axis + radius * (std::cos(a) * u + std::sin(a) * w);
      OutlineSample s;
      s.view = static_cast<uint32_t>(v);
      s.ray = (x - eye).normalized();
      s.normal = x;
      s.depth = (x - eye).norm();
      s.near = s.depth - interval / 2;
      s.far = s.depth + interval / 2;
      s.sigma = 0.002;
      s.px = *scene.views[v].Project(x);
      outline.push_back(s);
    }
  }
  return outline;
}

class RimPoints : public ::testing::Test {
 protected:
  Scene scene_ = DomeScene(36, 5);
  std::vector<OutlineSample> outline_ = SphereOutline(scene_, 80);
  double diagonal_ = 2 * std::sqrt(3.0);
};

TEST_F(RimPoints, LieOnTheSurfaceApartFromEachOther) {
  const RimEvidence rim = RimFromOutline(scene_, outline_, {}, {diagonal_});
  ASSERT_GT(rim.points.size(), 100u);
  EXPECT_THAT(rim.free_lines, ::testing::IsEmpty());
  for (size_t i = 0; i < rim.points.size(); ++i) {
    const RimPoint& p = rim.points[i];
    EXPECT_NEAR(p.position.norm(), 1, 0.005);
    EXPECT_GT(p.normal.dot(p.position.normalized()), 0.99);
    EXPECT_GT(p.sigma, 0);
    for (size_t j = 0; j < i; ++j) EXPECT_GT((p.position - rim.points[j].position).norm(), 0.01 * diagonal_);
  }
}

TEST_F(RimPoints, LeaveRoomAroundSparsePoints) {
  const Eigen::Vector3d known = RimFromOutline(scene_, outline_, {}, {diagonal_}).points.front().position;
  const RimEvidence rim = RimFromOutline(scene_, outline_, {known}, {diagonal_});
  ASSERT_FALSE(rim.points.empty());
  for (const RimPoint& p : rim.points) EXPECT_GT((p.position - known).norm(), 0.02 * diagonal_);
}

TEST_F(RimPoints, NeedOtherViewsAndAPlaceAlongTheRay) {
  std::vector<OutlineSample> one_view(outline_.begin(), outline_.begin() + 80);
  EXPECT_THAT(RimFromOutline(scene_, one_view, {}, {diagonal_}).points, ::testing::IsEmpty());
  const std::vector<OutlineSample> anywhere = SphereOutline(scene_, 80, 0.5 * diagonal_);
  EXPECT_THAT(RimFromOutline(scene_, anywhere, {}, {diagonal_}).points, ::testing::IsEmpty());
}

TEST_F(RimPoints, FromFewSidesAreAsWellKnownAsTheirPlaces) {
  const Scene few = DomeScene(8, 5);
  const double interval = 0.2 * diagonal_;
  const std::vector<OutlineSample> outline = SphereOutline(few, 80, interval);
  EXPECT_THAT(RimFromOutline(few, outline, {}, {diagonal_}).points, ::testing::IsEmpty());
  const RimEvidence rim = RimFromOutline(few, outline, {}, {.diagonal = diagonal_, .few_sides = true});
  ASSERT_GT(rim.points.size(), 100u);
  for (const RimPoint& p : rim.points) {
    EXPECT_NEAR(p.position.norm(), 1, p.sigma);
    EXPECT_GT(p.sigma, interval * interval / (8 * diagonal_));
  }
}

// Half of the object has points; the other half is expected to lie flat on the ground.
TEST_F(RimPoints, OfAHullAreWhereNothingElseIs) {
  const TriangleMesh hull = testing::Icosphere(4);
  TriangleMesh shape = hull;
  for (Eigen::Vector3d& x : shape.vertices) x.x() = std::max(x.x(), 0.1);
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& x : hull.vertices)
    if (x.x() > 0.1) points.push_back(x);
  const Eigen::Hyperplane<double, 3> ground(Eigen::Vector3d::UnitZ(), 0.5);
  RimEvidence rim;
  AddHullPoints(hull, shape, points, ground, rim);
  ASSERT_GT(rim.points.size(), 15u);
  for (size_t i = 0; i < rim.points.size(); ++i) {
    const RimPoint& p = rim.points[i];
    EXPECT_LT(p.position.x(), 0.05);
    EXPECT_GT(p.position.z(), -0.5);
    EXPECT_GT(p.normal.dot(p.position), 0.99);
    for (size_t j = 0; j < i; ++j) EXPECT_GT((p.position - rim.points[j].position).norm(), 0.03 * diagonal_);
  }
  RimEvidence nothing;
  AddHullPoints({}, shape, points, ground, nothing);
  EXPECT_THAT(nothing.points, ::testing::IsEmpty());
}

TEST_F(RimPoints, FreeLinesPassTheObject) {
  const RimEvidence rim = RimFromOutline(scene_, outline_, {}, {.diagonal = diagonal_, .carve = true});
  ASSERT_EQ(rim.free_lines.size(), outline_.size());
  for (const FreeLine& line : rim.free_lines) {
    const Eigen::Vector3d along = (line.from - line.eye).normalized();
    EXPECT_GT((line.eye - line.eye.dot(along) * along).norm(), 1);
  }
}

TEST_F(RimPoints, OutlinesFitTheirOwnSurfaceAlone) {
  const TriangleMesh sphere = testing::Icosphere(5);
  TriangleMesh large = sphere, small = sphere;
  for (Eigen::Vector3d& x : large.vertices) x *= 1.05;
  for (Eigen::Vector3d& x : small.vertices) x *= 0.95;
  EXPECT_GT(OutlineFit(scene_, outline_, sphere), 0.99);
  EXPECT_LT(OutlineFit(scene_, outline_, large), 0.01);
  EXPECT_LT(OutlineFit(scene_, outline_, small), 0.01);
  EXPECT_EQ(OutlineFit(scene_, {}, sphere), 1);
}

}  // namespace
}  // namespace glint
