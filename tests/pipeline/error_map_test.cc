#include "pipeline/error_map.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <numeric>
#include <opencv2/core.hpp>

#include "io/mesh_io.h"
#include "tests/pipeline/program.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;

TriangleMesh Sphere(double radius) {
  TriangleMesh mesh = testing::Icosphere(3);
  for (Eigen::Vector3d& v : mesh.vertices) v *= radius;
  return mesh;
}

TEST(ErrorMap, SignedAndInFractionsOfTheReference) {
  const TriangleMesh reference = Sphere(1);
  const double diagonal = Diagonal(reference);
  const ErrorField outside = MeasureErrors(Sphere(1.1), reference), inside = MeasureErrors(Sphere(0.9), reference);
  for (double d : outside.signed_rel) EXPECT_NEAR(d * diagonal, 0.1, 0.01);
  for (double d : inside.signed_rel) EXPECT_NEAR(d * diagonal, -0.1, 0.01);
  const double area = std::accumulate(outside.area.begin(), outside.area.end(), 0.0);
  EXPECT_NEAR(area, SurfaceArea(Sphere(1.1)), 1e-9);
}

TEST(ErrorMap, DividedIsTheSameSurface) {
  const TriangleMesh coarse = testing::Icosphere(0), fine = Divided(coarse, 0.2);
  EXPECT_EQ(fine.faces.size(), coarse.faces.size() * 64);  // edges of 1.05, halved three times
  EXPECT_NEAR(SurfaceArea(fine), SurfaceArea(coarse), 1e-9);
  EXPECT_NEAR(SignedVolume(fine), SignedVolume(coarse), 1e-9);
  EXPECT_EQ(Divided(coarse, 2).faces.size(), coarse.faces.size());
  EXPECT_EQ(Divided(coarse, 1e-3, 100).faces.size(), 80);
}

TEST(ErrorMap, HistogramHoldsTheWholeSurface) {
  ErrorField field;
  field.signed_rel = {-0.5, -0.1, -0.099, 0.05, 0.1, 0.3};
  field.area = {1, 1, 2, 4, 1, 1};
  const ErrorHistogram histogram = HistogramOf(field, 0.1, 4);
  EXPECT_DOUBLE_EQ(histogram.below, 0.1);
  EXPECT_DOUBLE_EQ(histogram.above, 0.1);
  ASSERT_EQ(histogram.shares.size(), 4u);
  EXPECT_DOUBLE_EQ(histogram.shares[0], 0.3);
  EXPECT_DOUBLE_EQ(histogram.shares[1], 0);
  EXPECT_DOUBLE_EQ(histogram.shares[3], 0.5);
}

TEST(ErrorMap, RangeIsRoundAndHoldsMost) {
  ErrorField field;
  field.signed_rel.assign(1000, -0.0031);
  field.signed_rel[0] = 7;  // one outlier
  EXPECT_DOUBLE_EQ(RoundErrorRange({field}), 0.005);
  field.signed_rel.assign(1000, 0.02);
  EXPECT_DOUBLE_EQ(RoundErrorRange({field}), 0.02);
  field.signed_rel.assign(1000, 0);
  EXPECT_GT(RoundErrorRange({field}), 0);
}

TEST(ErrorMap, ColoursTellTheSides) {
  const auto in = SignedErrorColor(-1, 1), none = SignedErrorColor(0, 1), out = SignedErrorColor(5, 1);
  EXPECT_GT(in[2], in[0] + 100);
  EXPECT_GT(out[0], out[2] + 100);
  EXPECT_THAT(none, Each(::testing::Ge(230)));
}

class CompareErrors : public ProgramTest {};

TEST_F(CompareErrors, PicturesAndMeshOfAnyTwoMeshes) {
  TriangleMesh open = Sphere(1);
  open.faces.resize(open.faces.size() / 2);  // half a ball
  WriteMesh(Path("a.ply"), Sphere(1.05));
  WriteMesh(Path("b.ply"), Sphere(0.8));
  for (const TriangleMesh& reference : {Sphere(1), open}) {
    WriteMesh(Path("reference.ply"), reference);
    const ProgramResult result =
        RunGlint({"compare", Path("a.ply"), Path("reference.ply"), "--before", Path("b.ply"), "--json", "--error-map",
                  Path("map.png"), "--error-mesh", Path("map.ply"), "--num-samples", "2000", "-q"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto candidates = nlohmann::json::parse(result.out)["candidates"];
    ASSERT_EQ(candidates.size(), 2);
    for (const auto& candidate : candidates) {
      double sum = candidate["histogram"]["below"].get<double>() + candidate["histogram"]["above"].get<double>();
      for (double share : candidate["histogram"]["shares"]) sum += share;
      EXPECT_NEAR(sum, 1, 1e-9);
    }
    EXPECT_EQ(ReadText(Path("map.png")).substr(1, 3), "PNG");
    const TriangleMesh map = ReadMesh(Path("map.ply"));
    EXPECT_EQ(map.colors.size(), map.vertices.size());
    ASSERT_EQ(map.scalars.size(), 1u);
    EXPECT_EQ(map.scalars[0].first, "quality");
    const bool closed = reference.faces.size() > open.faces.size();
    for (float quality : map.scalars[0].second) EXPECT_NEAR(quality, 0.05, closed ? 0.01 : 3);
  }
}

TEST_F(CompareErrors, WrongNamesAndRangesAreBadInput) {
  WriteMesh(Path("a.ply"), Sphere(1));
  const ProgramResult name = RunGlint({"compare", Path("a.ply"), Path("a.ply"), "--error-map", Path("map.jpg")});
  EXPECT_EQ(name.exit_code, 2);
  EXPECT_THAT(name.err, HasSubstr("ends in .png"));
  EXPECT_EQ(RunGlint({"compare", Path("a.ply"), Path("a.ply"), "--error-range", "0"}).exit_code, 2);
  EXPECT_EQ(RunGlint({"compare", Path("a.ply"), Path("a.ply"), "--error-map", Path("same.png"), "-q"}).exit_code, 0);
}

}  // namespace
}  // namespace glint
