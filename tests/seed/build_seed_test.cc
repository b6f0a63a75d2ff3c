#include "seed/build_seed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "colmap/model.h"
#include "core/error.h"
#include "core/median.h"
#include "core/parallel.h"
#include "geometry/closest_point.h"
#include "geometry/edge_topology.h"
#include "geometry/mesh_checks.h"
#include "geometry/pseudo_normals.h"
#include "seed/foot.h"
#include "seed/scene_layout.h"
#include "seed/sparse_surface.h"
#include "simulated_scene.h"

namespace glint {
namespace {

double MeanRadiusError(const TriangleMesh& mesh) {
  double sum = 0;
  size_t count = 0;
  for (const Eigen::Vector3d& v : mesh.vertices)
    if (v.z() > 0) {  // below, nothing is seen
      sum += std::abs(v.norm() - 1);
      ++count;
    }
  return sum / static_cast<double>(count);
}

void ExpectSound(const TriangleMesh& mesh, long genus) {
  const MeshChecks checks = CheckMeshSoundness(mesh);
  EXPECT_TRUE(checks.closed);
  EXPECT_TRUE(checks.oriented);
  EXPECT_TRUE(checks.manifold);
  EXPECT_FALSE(checks.inside_out);
  EXPECT_EQ(checks.num_components, 1u);
  EXPECT_EQ(checks.genus, genus);
}

class SphereSeed : public testing::TestWithParam<int> {};

TEST_P(SphereSeed, IsClosedAndSmoothIsNearer) {
  Scene scene = DomeScene(36, 5);
  AddSphere(scene, GetParam());
  SeedSummary summary;
  const SeedResult seed = BuildSeed(scene, {}, &summary);
  ASSERT_FALSE(seed.mesh.empty()) << summary.BriefReport();
  ExpectSound(seed.mesh, 0);
  ExpectSound(seed.smooth, 0);
  EXPECT_FALSE(summary.ground_found);
  EXPECT_GE(summary.num_object_points, scene.points.size() * 95 / 100);
  EXPECT_LT(MeanRadiusError(seed.smooth), GetParam() < 50 ? 0.1 : (GetParam() < 200 ? 0.02 : 0.005));
  EXPECT_TRUE(seed.region.contains(BoundingBox(seed.smooth)));
}

INSTANTIATE_TEST_SUITE_P(PointsOnTheObject, SphereSeed, testing::Values(40, 100, 1000));

TEST(BuildSeed, LeavesTheTableOut) {
  Scene scene = DomeScene(36, 5);
  AddSphere(scene, 300);
  const size_t on_object = scene.points.size();
  AddGround(scene, -1, 4, 30);
  SeedSummary summary;
  const SeedResult seed = BuildSeed(scene, {}, &summary);
  EXPECT_TRUE(summary.ground_found);
  EXPECT_EQ(summary.object_chosen_by, "ground and focus");
  EXPECT_NEAR(static_cast<double>(summary.num_object_points), static_cast<double>(on_object), 3);
  for (size_t i = on_object; i < scene.points.size(); ++i) EXPECT_FALSE(seed.point_used[i]);
  ASSERT_FALSE(seed.mesh.empty());
  ExpectSound(seed.mesh, 0);
  ExpectSound(seed.smooth, 0);
  EXPECT_LT(MeanRadiusError(seed.smooth), 0.01);
}

TEST(BuildSeed, BoxOverridesTheChoice) {
  Scene scene = DomeScene(36, 5);
  AddSphere(scene, 300);
  const size_t on_object = scene.points.size();
  AddGround(scene, -1, 4, 30);
  SeedOptions options;
  options.object.box = {0, 0, 0.2, 2.2, 2.2, 2.2};
  SeedSummary summary;
  const SeedResult seed = BuildSeed(scene, options, &summary);
  EXPECT_EQ(summary.object_chosen_by, "box");
  for (size_t i = on_object; i < scene.points.size(); ++i) EXPECT_FALSE(seed.point_used[i]);
  ExpectSound(seed.mesh, 0);
  options.object.box = {0, 0, 0, 1, 1};
  EXPECT_THROW(BuildSeed(scene, options), InputError);
  options.object.box = {0, 0, 0, 1, -1, 1};
  EXPECT_THROW(BuildSeed(scene, options), InputError);
}

// Points a tenth of their spacing off: a surface through each of them would be turned by about as many degrees.
TEST(BuildSeed, ManyPointsThatErrALittleDoNotDentIt) {
  Scene scene = DomeScene(36, 5);
  AddSphere(scene, 800);
  std::mt19937 random(3);
  std::normal_distribution<double> error(0, 0.008);
  for (ScenePoint& p : scene.points)
    for (int k = 0; k < 3; ++k) p.position[k] += error(random);
  const TriangleMesh smooth = BuildSeed(scene).smooth;
  ASSERT_FALSE(smooth.empty());
  const std::vector<Eigen::Vector3d> normals = ComputePseudoNormals(smooth, BuildEdgeTopology(smooth)).vertex;
  std::vector<double> turned_deg;
  for (size_t v = 0; v < normals.size(); ++v)
    if (smooth.vertices[v].z() > 0)
      turned_deg.push_back(std::acos(std::min(1.0, normals[v].normalized().dot(smooth.vertices[v].normalized()))) *
                           180 / M_PI);
  EXPECT_LT(Median(turned_deg), 2);
  EXPECT_LT(MeanRadiusError(smooth), 0.003);
}

TEST(BuildSeed, PointsBehindTheSurfaceDoNotDentIt) {
  Scene scene = DomeScene(36, 5);
  AddSphere(scene, 300);
  const size_t sound = scene.points.size();
  // Where a distant light's highlight triangulates: half a radius behind the surface, in few neighbouring views.
  for (int i = 0; i < 20; ++i) {
    ScenePoint point{Eigen::Vector3d::Zero(), {255, 255, 255}, 1.0, {}};
    const Eigen::Vector3d n = (scene.views[i].Center().normalized() + Eigen::Vector3d(0.3, 0.1, 0.6)).normalized();
    point.position = 0.5 * n;
    for (int k = 0; k < 3; ++k) {
      const View& view = scene.views[(i + 12 * k) % 36];
      point.observations.push_back(
          {static_cast<uint32_t>((i + 12 * k) % 36), view.Project(point.position)->cast<float>()});
    }
    scene.points.push_back(point);
  }
  const SeedResult seed = BuildSeed(scene);
  size_t used = 0;
  for (size_t i = sound; i < scene.points.size(); ++i) used += seed.point_used[i];
  EXPECT_LE(used, 2u);
  EXPECT_LT(MeanRadiusError(seed.smooth), 0.01);
}

TEST(BuildSeed, ATorusKeepsItsHole) {
  Scene scene = DomeScene(48, 6);
  const double big = 1, small = 0.35;
  for (int i = 0; i < 36; ++i)
    for (int j = 0; j < 14; ++j) {
      const double a = 2 * M_PI * (i + 0.5 * (j % 2)) / 36, b = 2 * M_PI * j / 14;
      const Eigen::Vector3d n(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b));
      const Eigen::Vector3d x = big * Eigen::Vector3d(std::cos(a), std::sin(a), 0) + small * n;
      AddPoint(scene, x, [&](const Eigen::Vector3d& eye) {
        const Eigen::Vector3d d = (eye - x).normalized();
        if (n.dot(d) < 0.1) return false;
        for (double t = 0.05; t < 3; t += 0.02) {  // its own other side
          const Eigen::Vector3d y = x + t * d;
          if (std::hypot(std::hypot(y.x(), y.y()) - big, y.z()) < small - 1e-3) return false;
        }
        return true;
      });
    }
  AddGround(scene, -0.6, 4, 30);
  const SeedResult seed = BuildSeed(scene);
  ASSERT_FALSE(seed.mesh.empty());
  ExpectSound(seed.mesh, 1);
  ExpectSound(seed.smooth, 1);
}

// Edges twice as long: a quarter of the work, where the result is held against itself alone.
SeedOptions Coarse() {
  SeedOptions options;
  options.smooth.edge_rel = 0.03;
  return options;
}

// A bowl of which a triangulation makes shreds: what fairs through itself, or runs away, is not taken.
TEST(BuildSeed, FewPointsOfAThinShellGiveASoundSeed) {
  constexpr double kInner = 0.94;
  for (const int count : {24, 30, 100, 160, 250}) {
    Scene scene = DomeScene(24, 5);
    for (int i = 0; i < count; ++i) {
      const double z = -(i + 0.5) / count, turn = 2.4 * i, across = std::sqrt(1 - z * z);
      const bool inner = i % 2 == 1;
      const Eigen::Vector3d n(across * std::cos(turn), across * std::sin(turn), z), x = (inner ? kInner : 1.0) * n;
      AddPoint(scene, x, [&](const Eigen::Vector3d& eye) {
        if (!inner) return n.dot(eye - x) > 0.15 * (eye - x).norm();
        const Eigen::Vector3d through = x + (eye - x) * (x.z() / (x.z() - eye.z()));  // where it leaves the bowl
        return through.head<2>().norm() < kInner;
      });
    }
    AddGround(scene, -1, 4, 20);
    SeedSummary summary;
    const SeedResult seed = BuildSeed(scene, Coarse(), &summary);
    ASSERT_FALSE(seed.smooth.empty()) << count << ": " << summary.BriefReport();
    EXPECT_TRUE(CheckMeshSoundness(seed.smooth).sound()) << count;
    EXPECT_LT(Diagonal(seed.smooth), 4) << count;
  }
}

// A car's hood on a floor without texture: the plane that most points lie on is the object.
TEST(BuildSeed, MarksWhereTheObjectStands) {
  Scene scene = DomeScene(36, 5);
  AddSphere(scene, 300);
  AddGround(scene, -1, 4, 30);
  const SeedResult seed = BuildSeed(scene, Coarse());
  const auto foot = std::find_if(seed.smooth.scalars.begin(), seed.smooth.scalars.end(),
                                 [](const auto& scalar) { return scalar.first == kFootScalar; });
  ASSERT_NE(foot, seed.smooth.scalars.end());
  int on_foot = 0;
  for (size_t v = 0; v < foot->second.size(); ++v) {
    on_foot += foot->second[v] > 0;
    const double z = seed.smooth.vertices[v].z();
    EXPECT_TRUE(foot->second[v] > 0 || z > -0.99) << z;
    EXPECT_TRUE(foot->second[v] == 0 || z < -0.9) << z;
  }
  EXPECT_GT(on_foot, 0);
}

TEST(BuildSeed, AFlatObjectIsNotTheGround) {
  Scene scene = DomeScene(24, 5);
  const auto seen = [](const Eigen::Vector3d& eye) { return eye.z() > 0.5; };
  for (int i = 0; i < 90; ++i) {
    const double r = std::sqrt((i + 0.5) / 90), turn = 2.4 * i;
    AddPoint(scene, {r * std::cos(turn), r * std::sin(turn), 0.04 * (1 - r * r)}, seen);
  }
  for (int i = 0; i < 3; ++i)  // its rim goes down to the floor
    AddPoint(scene, {1.02 * std::cos(i), 1.02 * std::sin(i), -0.2 * (i + 1)}, seen);
  for (int i = 0; i < 4; ++i) AddPoint(scene, {2.2 * std::cos(i), 2.2 * std::sin(i), -0.5}, seen);
  SeedSummary summary;
  const SeedResult seed = BuildSeed(scene, Coarse(), &summary);
  EXPECT_GE(summary.num_object_points, 80u) << summary.BriefReport();
  ASSERT_FALSE(seed.smooth.empty()) << summary.BriefReport();
}

// A bowl whose outside is blank but for a few points: the space in it, into which all look, is not the object.
// Where a bowl of radius `radius` and its mouth at 0 is at a depth (of the radius) and a turn.
Eigen::Vector3d OnBowl(double radius, double depth, double turn) {
  const double r = std::sqrt(1 - depth * depth);
  return {radius * r * std::cos(turn), radius * r * std::sin(turn), -radius * depth};
}

// Many points on its inside, few on its outside.
Scene BowlScene(int inside = 220, int outside = 60) {
  Scene scene = DomeScene(9, 5);
  for (int i = 0; i < inside; ++i) {
    const Eigen::Vector3d x = OnBowl(1, (i + 0.5) / inside, 2.4 * i);
    AddPoint(scene, x, [&](const Eigen::Vector3d& eye) {
      const double share = x.z() / (x.z() - eye.z());  // of the way, where it leaves the mouth
      return (x + share * (eye - x)).norm() < 0.97;
    });
  }
  for (int i = 0; i < outside; ++i) {
    const Eigen::Vector3d x = OnBowl(1.06, 0.7 * i / outside, 2.4 * i);
    AddPoint(scene, x, [&](const Eigen::Vector3d& eye) { return x.dot(eye - x) > 0.2; });
  }
  AddGround(scene, -1.1, 4, 12);
  return scene;
}

TEST(BuildSeed, ABowlIsItsWallAndNotWhatIsInIt) {
  const Scene scene = BowlScene();
  const SeedResult seed = BuildSeed(scene, Coarse());
  ASSERT_FALSE(seed.smooth.empty());
  EXPECT_LT(SignedVolume(seed.smooth), 0.4 * 2 * M_PI / 3);
  const ClosestPointQuery query(seed.smooth);
  std::vector<double> off;
  for (int i = 0; i < 100; ++i)
    off.push_back(std::sqrt(query.Find(OnBowl(1, 0.3 + 0.7 * i / 100, 2.4 * i))->squared_distance));
  EXPECT_LT(Median(off), 0.02);
}

// Two sheets that are closer to each other than their points: fairing must not pull one through the other, and fill the
// bowl with what is left.
TEST(BuildSeed, AWallOfFewPointsIsNotTurnedInsideOut) {
  for (const int inside : {40, 60, 80, 100, 130, 170}) {
    const SeedResult seed = BuildSeed(BowlScene(inside, inside / 10), Coarse());
    ASSERT_FALSE(seed.smooth.empty()) << inside;
    EXPECT_LT(SignedVolume(seed.smooth), 0.4 * 2 * M_PI / 3) << inside;
  }
}

// Outlines show its outside but for the foot, which nobody sees: there it is still a wall.
TEST(BuildSeed, ABowlWithOutlinesIsStillAWall) {
  const Scene scene = BowlScene();
  const PointReliability reliability = JudgePoints(scene, {});
  const ObjectChoice choice = ChooseObject(scene, reliability, {}, {}, nullptr, Progress::Silent());
  const SparseSurface alone = MakeSparseSurface(scene, reliability, choice, {});
  EXPECT_TRUE(alone.is_wall);
  RimEvidence rim;
  rim.depth = 0.03;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d x = OnBowl(1.06, 0.7 * i / 300, 2.4 * i);
    rim.points.push_back({x, x.normalized(), 0.005});
  }
  rim.of_a_wall = alone.is_wall;
  const SparseSurface with = MakeSparseSurface(scene, reliability, choice, {}, rim);
  EXPECT_TRUE(with.is_wall);
  ASSERT_FALSE(with.mesh.empty());
  const ClosestPointQuery query(with.mesh);
  for (int i = 0; i < 50; ++i)
    EXPECT_LT(query.Find(OnBowl(1, 0.9 + 0.1 * i / 50, 2.4 * i))->squared_distance, 0.05 * 0.05) << i;
}

// A windscreen over a textured box: its frame and some dust have points, and the box is seen through it.
TEST(BuildSeed, APaneIsWhatItsFrameAndDustLieOn) {
  Scene scene = DomeScene(24, 5);
  const auto all = [](const Eigen::Vector3d&) { return true; };
  const auto on_pane = [](double r, double turn) {
    return Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), 0.6 - 0.3 * r * r);
  };
  for (int i = 0; i < 80; ++i) AddPoint(scene, on_pane(0.88 + 0.12 * (i % 3) / 2, 2.4 * i), all);
  for (int i = 0; i < 16; ++i) AddPoint(scene, on_pane(0.85 * std::sqrt((i + 0.5) / 16), 2.4 * i), all);
  for (int i = 0; i < 80; ++i) {
    const double r = 0.85 * std::sqrt((i + 0.5) / 80), turn = 2.4 * i + 1;
    AddPoint(scene, {r * std::cos(turn), r * std::sin(turn), 0.1}, all);
  }
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d x(0.9 * std::cos(2.4 * i), 0.9 * std::sin(2.4 * i), -0.5 + 0.7 * i / 60);
    AddPoint(scene, x, [&](const Eigen::Vector3d& eye) { return x.head<2>().dot((eye - x).head<2>()) > 0.3; });
  }
  SeedOptions options = Coarse();
  const auto farthest = [&](const TriangleMesh& mesh) {
    const ClosestPointQuery query(mesh);
    double most = 0;
    for (int i = 0; i < 50; ++i)
      most = std::max(most, std::sqrt(query.Find(on_pane(0.9 * std::sqrt(i / 50.0), 2.4 * i))->squared_distance));
    return most;
  };
  const SeedResult opaque = BuildSeed(scene, options);
  options.surface.see_through = true;
  const SeedResult glass = BuildSeed(scene, options);
  ASSERT_FALSE(glass.smooth.empty());
  EXPECT_LT(farthest(glass.smooth), 0.02);
  EXPECT_GT(farthest(opaque.smooth), 0.1);
  // What lies on it is used, what lies behind it is not.
  for (size_t i = 0; i < scene.points.size(); ++i) {
    const Eigen::Vector3d& x = scene.points[i].position;
    const bool dust = x.z() > 0.25 && x.head<2>().norm() < 0.86, inside = x.z() == 0.1 && x.head<2>().norm() < 0.6;
    EXPECT_TRUE(glass.point_used[i] || !dust) << x.transpose();
    EXPECT_FALSE(glass.point_used[i] && inside) << x.transpose();
  }
}

TEST(BuildSeed, FollowsScaleAndPlaceOfTheWorld) {
  Scene scene = DomeScene(36, 5);
  AddSphere(scene, 150);
  AddGround(scene, -1, 4, 20);
  const SeedResult seed = BuildSeed(scene, Coarse());
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()));
  for (double scale : {1e-6, 1e6}) {
    const Eigen::Vector3d shift = scale * Eigen::Vector3d(3, -20, 7);
    Scene moved = scene;
    for (ScenePoint& p : moved.points) p.position = scale * (turn * p.position) + shift;
    for (View& v : moved.views) {
      const Eigen::Vector3d center = scale * (turn * v.Center()) + shift;
      v.cam_from_world.rotation = v.cam_from_world.rotation * turn.conjugate();
      v.cam_from_world.translation = -(v.cam_from_world.rotation * center);
    }
    const SeedResult other = BuildSeed(moved, Coarse());
    EXPECT_EQ(other.point_used, seed.point_used);
    ASSERT_FALSE(other.smooth.empty());
    TriangleMesh back = other.smooth;
    for (Eigen::Vector3d& v : back.vertices) v = turn.conjugate() * (v - shift) / scale;
    const ClosestPointQuery query(seed.smooth);
    double worst = 0;
    for (const Eigen::Vector3d& v : back.vertices) worst = std::max(worst, std::sqrt(query.Find(v)->squared_distance));
    EXPECT_LT(worst, 0.05) << "at scale " << scale;
  }
}

TEST(BuildSeed, IsTheSameForAnyNumberOfThreads) {
  Scene scene = DomeScene(36, 5);
  AddSphere(scene, 200);
  AddGround(scene, -1, 4, 20);
  SeedResult results[2];
  for (int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    results[threads - 1] = BuildSeed(scene, Coarse());
  }
  EXPECT_EQ(results[0].mesh.vertices, results[1].mesh.vertices);
  EXPECT_EQ(results[0].mesh.faces, results[1].mesh.faces);
  EXPECT_EQ(results[0].smooth.vertices, results[1].smooth.vertices);
  EXPECT_EQ(results[0].smooth.faces, results[1].smooth.faces);
}

TEST(BuildSeed, SaysWhyThereIsNone) {
  SeedSummary summary;
  EXPECT_TRUE(BuildSeed(Scene(), {}, &summary).mesh.empty());
  EXPECT_FALSE(summary.warnings.empty());

  Scene few = DomeScene(10, 5);
  AddPoint(few, {0, 0, 0}, [](const Eigen::Vector3d&) { return true; });
  EXPECT_TRUE(BuildSeed(few, {}, &summary).mesh.empty());
  EXPECT_FALSE(summary.warnings.empty());

  Scene flat = DomeScene(10, 5);
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j)
      AddPoint(flat, {0.2 * i - 0.4, 0.2 * j - 0.4, 0}, [](const Eigen::Vector3d&) { return true; });
  EXPECT_TRUE(BuildSeed(flat, {}, &summary).mesh.empty());
  EXPECT_FALSE(summary.warnings.empty());

  Scene same = DomeScene(10, 5);
  for (int i = 0; i < 50; ++i) AddPoint(same, {0.1, 0.1, 0.1}, [](const Eigen::Vector3d&) { return true; });
  EXPECT_TRUE(BuildSeed(same, {}, &summary).mesh.empty());
}

TEST(SceneLayout, FindsFocusAndGround) {
  Scene scene = DomeScene(36, 5);
  AddSphere(scene, 300);
  AddGround(scene, -1, 4, 30);
  const std::vector<uint8_t> use(scene.points.size(), 1);
  const Focus focus = FindFocus(scene, use);
  EXPECT_LT(focus.center.norm(), 0.1);
  EXPECT_NEAR(focus.distance, 5, 0.1);
  const auto ground = FindGround(scene, use, focus);
  ASSERT_TRUE(ground.has_value());
  EXPECT_NEAR(ground->plane.normal().z(), 1, 1e-9);
  EXPECT_NEAR(ground->plane.signedDistance(Eigen::Vector3d::Zero()), 1, 1e-6);
}

// A low object with many points, of which more lie about a plane through its flanks than there are on the floor.
TEST(SceneLayout, FindsTheGroundOfALowObject) {
  for (const int on_floor : {24, 110}) {
    Scene scene = DomeScene(36, 5);
    const auto everywhere = [](const Eigen::Vector3d&) { return true; };
    std::mt19937 random(3);
    std::uniform_real_distribution<double> side(-1, 1);
    for (int i = 0; i < 400; ++i) {
      const Eigen::Vector2d p(side(random), side(random));
      AddPoint(scene, {p.x(), 0.8 * p.y(), 0.37 * (1 - p.array().square().square().maxCoeff())}, everywhere);
    }
    for (int i = 0; i < on_floor; ++i) {
      const double angle = 2 * M_PI * i / on_floor, radius = 1.7 + 0.6 * side(random);
      AddPoint(scene, {radius * std::cos(angle), radius * std::sin(angle), 0.002 * side(random)}, everywhere);
    }
    const std::vector<uint8_t> use(scene.points.size(), 1);
    const auto ground = FindGround(scene, use, FindFocus(scene, use));
    ASSERT_TRUE(ground.has_value()) << on_floor;
    EXPECT_GT(ground->plane.normal().z(), std::cos(0.5 * M_PI / 180)) << on_floor;
    EXPECT_NEAR(ground->plane.signedDistance(Eigen::Vector3d::Zero()), 0, 0.01) << on_floor;
  }
}

TEST(BuildSeed, IsolatesTheVaseFromItsTable) {
  const std::filesystem::path folder = std::filesystem::path(GLINT_SOURCE_DIR) / "../shared/data/vase/project/sparse/0";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "needs ../shared/data/vase";
  SeedSummary summary;
  const SeedResult seed = BuildSeed(MakeScene(ReadModel(folder)), {}, &summary);
  ASSERT_FALSE(seed.smooth.empty());
  ExpectSound(seed.mesh, 0);
  ExpectSound(seed.smooth, 0);
  EXPECT_TRUE(summary.ground_found);
  // The vase is 0.824 × 0.824 × 1.2215 in a frame 0.57363 times the model's.
  const double diagonal = std::sqrt(2 * 0.824 * 0.824 + 1.2215 * 1.2215) / 0.57363;
  EXPECT_NEAR(Diagonal(seed.smooth), diagonal, 0.25 * diagonal);
  EXPECT_LT(summary.smooth_residual_rel, 0.002);
}

}  // namespace
}  // namespace glint
