#include "synthetic/shapes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "core/error.h"
#include "synthetic/random.h"
#include "synthetic/shape_mesh.h"
#include "synthetic/shape_tracer.h"

namespace glint {
namespace {

using Eigen::Vector3d;

class ShapeTest : public testing::TestWithParam<std::tuple<std::string_view, uint64_t>> {
 protected:
  ShapeTest() : shape_(MakeShape(std::get<0>(GetParam()), std::get<1>(GetParam()))) {}

  Vector3d PointInside(Random& random, double factor) const {
    return shape_->center() + factor * shape_->radius() * std::cbrt(random.Uniform()) * random.UnitVector();
  }

  std::shared_ptr<const ImplicitShape> shape_;
};

TEST_P(ShapeTest, GradientIsTheDerivative) {
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const Vector3d x = PointInside(random, 1.1);
    if (std::abs(shape_->Value(x)) > 0.1) continue;
    const Vector3d gradient = shape_->Gradient(x);
    for (int k = 0; k < 3; ++k) {
      const Vector3d step = 1e-5 * Vector3d::Unit(k);
      const double numeric = (shape_->Value(x + step) - shape_->Value(x - step)) / 2e-5;
      EXPECT_NEAR(gradient[k], numeric, 1e-6) << "at " << x.transpose();
    }
  }
}

TEST_P(ShapeTest, ValueNeverExceedsTheDistance) {
  Random random(2);
  for (int i = 0; i < 5000; ++i) {
    const Vector3d a = PointInside(random, 1);
    const Vector3d b = i % 2 ? PointInside(random, 1) : Vector3d(a + 0.02 * random.UnitVector());
    if ((b - shape_->center()).norm() > shape_->radius()) continue;
    EXPECT_LE(std::abs(shape_->Value(a) - shape_->Value(b)), (a - b).norm() * (1 + 1e-9));
  }
}

TEST_P(ShapeTest, LiesInsideItsBoundingSphere) {
  Random random(3);
  int inside = 0;
  for (int i = 0; i < 3000; ++i) {
    EXPECT_GE(shape_->Value(shape_->center() + 1.0001 * shape_->radius() * random.UnitVector()), 0);
    inside += shape_->Value(PointInside(random, 1)) < 0;
  }
  EXPECT_GT(inside, 40);
  EXPECT_GT(shape_->radius(), 0.9);
  EXPECT_LT(shape_->radius(), 1.6);
}

TEST_P(ShapeTest, MeshIsClosedOrientedAndOnTheSurface) {
  const TriangleMesh mesh = MeshShape(*shape_, 80);
  std::map<std::pair<int, int>, int> directed;
  for (const Eigen::Vector3i& f : mesh.faces)
    for (int k = 0; k < 3; ++k) ++directed[{f[k], f[(k + 1) % 3]}];
  for (const auto& [edge, count] : directed) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(directed.count({edge.second, edge.first}), 1u);
  }
  const auto characteristic = static_cast<long>(mesh.vertices.size()) - static_cast<long>(directed.size() / 2) +
                              static_cast<long>(mesh.faces.size());
  EXPECT_EQ(characteristic, std::get<0>(GetParam()) == "torus" ? 0 : 2);
  EXPECT_GT(SignedVolume(mesh), 0);
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_LT(std::abs(shape_->Value(mesh.vertices[i])), 1e-10);
    EXPECT_GT(shape_->Value(mesh.vertices[i] + 1e-3 * mesh.normals[i]), 0);
    EXPECT_LT(shape_->Value(mesh.vertices[i] - 1e-3 * mesh.normals[i]), 0);
  }
}

TEST_P(ShapeTest, TracerAgreesWithPlainSphereTracing) {
  const ShapeTracer tracer(shape_);
  Random random(4);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d origin = shape_->center() + 4 * random.UnitVector();
    const Vector3d direction = (PointInside(random, 0.9) - origin).normalized();
    const auto plain = TraceRay(*shape_, origin, direction, 0, 10);
    const auto quick = tracer.Trace(origin, direction, 0, 10);
    const bool grazing = plain ? plain->normal.dot(direction) > -0.05 : quick && quick->normal.dot(direction) > -0.05;
    if (grazing) continue;
    ASSERT_EQ(plain.has_value(), quick.has_value()) << origin.transpose() << " along " << direction.transpose();
    if (!plain) continue;
    ++hits;
    EXPECT_NEAR(plain->t, quick->t, 1e-8);
    EXPECT_LT(std::abs(shape_->Value(quick->position)), 1e-10);
    EXPECT_TRUE(tracer.Meets(origin, direction, 0, 10));
    EXPECT_FALSE(tracer.Meets(origin, direction, 0, plain->t - 0.01));
  }
  EXPECT_GT(hits, 500);
}

INSTANTIATE_TEST_SUITE_P(AllShapes, ShapeTest,
                         testing::Combine(testing::ValuesIn(ShapeNames()), testing::Values(1u, 8u)),
                         [](const auto& parameters) {
                           return std::string(std::get<0>(parameters.param)) + "_" +
                                  std::to_string(std::get<1>(parameters.param));
                         });

TEST(Shapes, UnknownNameIsAnInputError) { EXPECT_THROW(MakeShape("cube", 1), InputError); }

TEST(Shapes, SeedsVaryTheFreeForms) {
  for (std::string_view name : {"hood", "blob", "touching", "pane", "bowl"}) {
    const auto a = MakeShape(name, 1), b = MakeShape(name, 2), again = MakeShape(name, 1);
    const Vector3d x(0.3, 0.2, 0.4);
    EXPECT_NE(a->Value(x), b->Value(x)) << name;
    EXPECT_EQ(a->Value(x), again->Value(x)) << name;
  }
}

TEST(Shapes, HoodIsConvexOnTop) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const auto hood = MakeShape("hood", seed);
    const auto height = [&](double x, double y) {
      return TraceRay(*hood, {x, y, 2}, -Vector3d::UnitZ(), 0, 10)->position.z();
    };
    for (double x = -0.6; x <= 0.6; x += 0.1)
      for (double y = -0.4; y <= 0.4; y += 0.1) {
        const double d = 0.02, here = height(x, y);
        const double xx = height(x + d, y) + height(x - d, y) - 2 * here;
        const double yy = height(x, y + d) + height(x, y - d) - 2 * here;
        const double xy =
            0.25 * (height(x + d, y + d) + height(x - d, y - d) - height(x + d, y - d) - height(x - d, y + d));
        EXPECT_LT(xx, 0);
        EXPECT_GT(xx * yy - xy * xy, 0) << "seed " << seed << " at " << x << ", " << y;
      }
  }
}

TEST(Shapes, PlacedShapeKeepsLengths) {
  std::shared_ptr<const ImplicitShape> torus = MakeShape("torus", 3);
  const Similarity placement{1e3, Eigen::Quaterniond(Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized())),
                             Vector3d(5, -7, 11)};
  const auto placed = PlaceShape(torus, placement);
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Vector3d x = random.UnitVector() * random.Uniform(0, 1.3);
    EXPECT_NEAR(placed->Value(placement * x), 1e3 * torus->Value(x), 1e-9);
    EXPECT_LT((placed->Gradient(placement * x) - placement.rotation * torus->Gradient(x)).norm(), 1e-12);
    EXPECT_LT((placement.InverseOf(placement * x) - x).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace glint
