#include "refine/bundle.h"

#include <ceres/ceres.h>
#include <ceres/gradient_checker.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "refine/chord_residual.h"
#include "refine/neighbors.h"
#include "tests/support/ball_mesh.h"
#include "tests/support/ellipsoid_scene.h"

namespace glint {
namespace {

using testing::DistantLight;
using testing::Ellipsoid;
using testing::MakeEllipsoidContacts;

double MedianDepthError(const std::vector<Contact>& contacts, const std::vector<Contact>& truth) {
  std::vector<double> errors;
  for (size_t i = 0; i < contacts.size(); ++i)
    if (contacts[i].accepted) errors.push_back(std::abs(contacts[i].depth - truth[i].depth));
  std::sort(errors.begin(), errors.end());
  return errors[errors.size() / 2];
}

TEST(ChordResidual, IsZeroOnASphere) {
  const Ellipsoid sphere{{1, 1, 1}};
  const std::vector<Light> lights = {DistantLight(1, 0, 1)};
  const auto scene = MakeEllipsoidContacts(sphere, lights, 12, 0);
  for (const Contact& a : scene.contacts)
    for (const Contact& b : scene.contacts) {
      if (&a == &b) continue;
      const ChordResidual residual{{a, lights[0]}, {b, lights[0]}, 1};
      double r;
      residual(&a.depth, &b.depth, lights[0].vector.data(), &r);
      EXPECT_NEAR(r, 0, 1e-12);
    }
}

TEST(ChordResidual, JacobiansAgreeWithFiniteDifferences) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (LightType type : {LightType::kDistant, LightType::kPoint})
    for (LightFrame frame : {LightFrame::kWorld, LightFrame::kCamera}) {
      Light light = DistantLight(0.3, 0.4, 0.9);
      light.type = type;
      light.frame = frame;
      if (type == LightType::kPoint) light.vector *= 3;
      auto scene = MakeEllipsoidContacts(Ellipsoid(), {DistantLight(0.3, 0.4, 0.9)}, 6, 1);
      Contact &a = scene.contacts[0], &b = scene.contacts[3];
      const ceres::AutoDiffCostFunction<ChordResidual, 1, 1, 1, 3> cost(new ChordResidual{{a, light}, {b, light}, 100});
      const ceres::AutoDiffCostFunction<PointChordResidual, 1, 1, 3> point_cost(
          new PointChordResidual{{a, light}, scene.points[0].position, scene.points[0].normal, 100});
      Eigen::Vector3d vector = light.vector;
      const double* parameters[] = {&a.depth, &b.depth, vector.data()};
      const double* point_parameters[] = {&a.depth, vector.data()};
      ceres::NumericDiffOptions options;
      ceres::GradientChecker::ProbeResults results;
      EXPECT_TRUE(ceres::GradientChecker(&cost, static_cast<std::vector<const ceres::Manifold*>*>(nullptr), options)
                      .Probe(parameters, 1e-5, &results))
          << results.error_log;
      EXPECT_TRUE(
          ceres::GradientChecker(&point_cost, static_cast<std::vector<const ceres::Manifold*>*>(nullptr), options)
              .Probe(point_parameters, 1e-5, &results))
          << results.error_log;
    }
}

// Two balls beside each other: between them there is no surface for chords to follow.
TEST(SolveBundle, ChordsStayOnOneSheet) {
  const Ellipsoid ball{{1, 1, 1}};
  const std::vector<Light> lights = {DistantLight(0.2, 0.1, 1)};
  std::vector<Contact> contacts = MakeEllipsoidContacts(ball, lights, 40, 3).contacts;
  const size_t count = contacts.size();
  for (size_t i = 0; i < count; ++i) {
    contacts.push_back(contacts[i]);
    contacts.back().origin.x() += 2.5;
  }
  for (Contact& c : contacts) c.prior_depth = c.depth;
  TriangleMesh balls = testing::BallMesh({0, 0, 0}, 1, 40);
  const TriangleMesh second = testing::BallMesh({2.5, 0, 0}, 1, 40);
  const int first = static_cast<int>(balls.vertices.size());
  balls.vertices.insert(balls.vertices.end(), second.vertices.begin(), second.vertices.end());
  for (const Eigen::Vector3i& f : second.faces) balls.faces.emplace_back(f + Eigen::Vector3i::Constant(first));
  const SurfaceQuery surface(balls);
  BundleOptions options;
  options.rounds = 1;
  const auto chords = [&](std::vector<Contact> some, const SurfaceQuery* on) {
    std::vector<Light> fixed = lights;
    return SolveBundle({}, Diagonal(balls), {false}, options, some, fixed, nullptr, on).num_chords;
  };
  const int one = chords({contacts.begin(), contacts.begin() + static_cast<std::ptrdiff_t>(count)}, nullptr);
  const int off_surface = chords(contacts, nullptr) - 2 * one, left = chords(contacts, &surface) - 2 * one;
  EXPECT_GT(off_surface, one / 10);  // across the gap
  EXPECT_LE(left, off_surface / 10);
  EXPECT_GT(left, -one / 10);  // and those on either ball stay
}

TEST(SectorNeighbors, SpreadOverTheTangentPlaneAndNeverThemselves) {
  std::vector<Eigen::Vector3d> positions, normals;
  for (int x = -5; x <= 5; ++x)
    for (int y = -5; y <= 5; ++y) {
      positions.emplace_back(x, y, 0.0);
      normals.emplace_back(0, 0, 1);
    }
  NeighborOptions options;
  options.count = 6;
  const auto neighbors = SectorNeighbors(positions, normals, positions, normals, options);
  const int center = 60;
  EXPECT_GE(neighbors[center].size(), 4u);
  EXPECT_THAT(neighbors[center], ::testing::Not(::testing::Contains(center)));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int j : neighbors[center]) sum += positions[j];
  EXPECT_LE(sum.norm(), 2);
}

TEST(SolveBundle, RecoversDepthsFromASeedThatIsOff) {
  const Ellipsoid shape;
  std::vector<Light> lights = {DistantLight(1, 0.2, 1), DistantLight(-0.8, 0.5, 1)};
  const auto truth = MakeEllipsoidContacts(shape, lights, 40, 150);
  std::vector<Contact> contacts = truth.contacts;
  for (Contact& c : contacts) c.depth = c.prior_depth = c.depth + 0.1;
  const BundleSummary summary =
      SolveBundle(truth.points, shape.Diagonal(), {false, false}, BundleOptions(), contacts, lights);
  EXPECT_TRUE(summary.usable);
  EXPECT_LT(summary.final_cost, summary.initial_cost);
  EXPECT_LT(MedianDepthError(contacts, truth.contacts), 0.002);
  EXPECT_EQ(summary.num_rejected, 0);
}

TEST(SolveBundle, FindsAWrongLight) {
  const Ellipsoid shape;
  const std::vector<Light> true_lights = {DistantLight(1, 0.2, 1), DistantLight(-0.8, 0.5, 1)};
  const auto truth = MakeEllipsoidContacts(shape, true_lights, 40, 150);
  std::vector<Contact> contacts = truth.contacts;
  std::vector<Light> lights = {DistantLight(1.2, 0.1, 0.9), DistantLight(-0.7, 0.6, 1.1)};
  for (Contact& c : contacts) c.depth = c.prior_depth = c.depth + 0.05;
  const BundleSummary summary =
      SolveBundle(truth.points, shape.Diagonal(), {true, true}, BundleOptions(), contacts, lights);
  for (size_t k = 0; k < lights.size(); ++k) {
    EXPECT_NEAR(lights[k].vector.norm(), 1, 1e-12);
    const double error_deg = std::acos(lights[k].vector.dot(true_lights[k].vector)) * 180 / M_PI;
    EXPECT_LT(error_deg, 1.0);
    EXPECT_GT(summary.lights[k].sigma, 0);
    EXPECT_LT(error_deg, 4 * summary.lights[k].sigma + 0.2);
  }
}

TEST(SolveBundle, RejectsWhatContradictsItsNeighbours) {
  const Ellipsoid shape;
  std::vector<Light> lights = {DistantLight(1, 0.2, 1)};
  const auto truth = MakeEllipsoidContacts(shape, lights, 150, 300);
  std::vector<Contact> contacts = truth.contacts;
  // A reflection of something else: its ray is right, its normal is off by about 15 degrees.
  lights.push_back(DistantLight(0.8, 0.8, 0.8));
  contacts[60].light = 1;
  SolveBundle(truth.points, shape.Diagonal(), {false, false}, BundleOptions(), contacts, lights);
  EXPECT_FALSE(contacts[60].accepted);
  EXPECT_GE(std::count_if(contacts.begin(), contacts.end(), [](const Contact& c) { return c.accepted; }),
            static_cast<long>(contacts.size()) - 2);
}

TEST(SolveBundle, ScalesWithTheScene) {
  const Ellipsoid shape;
  std::vector<Light> lights = {DistantLight(1, 0.2, 1)};
  const auto truth = MakeEllipsoidContacts(shape, lights, 30, 100);
  const auto solve = [&](double scale) {
    std::vector<Contact> contacts = truth.contacts;
    std::vector<SurfacePoint> points = truth.points;
    for (Contact& c : contacts) {
      c.origin *= scale;
      c.cam_from_world.translation *= scale;
      c.depth = c.prior_depth = scale * (c.depth + 0.1);
    }
    for (SurfacePoint& p : points) {
      p.position *= scale;
      p.sigma *= scale;
    }
    std::vector<Light> copy = lights;
    SolveBundle(points, scale * shape.Diagonal(), {false}, BundleOptions(), contacts, copy);
    std::vector<double> depths;
    for (const Contact& c : contacts) depths.push_back(c.depth / scale);
    return depths;
  };
  EXPECT_THAT(solve(1000), ::testing::Pointwise(::testing::DoubleNear(1e-4), solve(1)));
}

TEST(SolveBundle, NoContactsAndTwoContactsAreNoError) {
  std::vector<Light> lights = {DistantLight(0, 0, 1)};
  std::vector<Contact> none;
  EXPECT_EQ(SolveBundle({}, 1, {false}, BundleOptions(), none, lights).num_contacts, 0);
  auto two = MakeEllipsoidContacts(Ellipsoid(), lights, 2, 0).contacts;
  EXPECT_EQ(SolveBundle({}, 1, {false}, BundleOptions(), two, lights).num_chords, 0);
}

}  // namespace
}  // namespace glint
