#include "refine/refine.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "tests/refine/ellipsoid_problem.h"

namespace glint {
namespace {

using testing::DistantLight;
using testing::MakeProblem;
using testing::Problem;

RefineOptions FastOptions() {
  RefineOptions options;
  options.voxel_rel = 1.0 / 64;
  options.levels = 2;
  return options;
}

struct Errors {
  double normal_deg = 0;
  double distance_rel = 0;
};

// Mean over the vertices near true contacts: normal against the ellipsoid's, and first-order distance to it.
Errors NearContacts(const Problem& p, const TriangleMesh& mesh, double scale = 1,
                    const Eigen::Vector3d& offset = Eigen::Vector3d::Zero()) {
  Errors errors;
  int count = 0;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    double nearest = 1e300;
    for (const Eigen::Vector3d& c : p.contact_positions)
      nearest = std::min(nearest, (c - mesh.vertices[v]).norm() / scale);
    if (nearest > 0.06) continue;
    const Eigen::Vector3d x = (mesh.vertices[v] - offset) / scale;
    const Eigen::Vector3d q = x.cwiseQuotient(p.shape.radii);
    const Eigen::Vector3d gradient = q.cwiseQuotient(p.shape.radii) / q.norm();
    errors.distance_rel += std::abs((q.norm() - 1) / gradient.norm()) / p.shape.Diagonal();
    const double cosine = std::clamp(gradient.normalized().dot(mesh.normals[v]), -1.0, 1.0);
    errors.normal_deg += std::acos(cosine) * 180 / M_PI;
    ++count;
  }
  EXPECT_GT(count, 50);
  errors.normal_deg /= count;
  errors.distance_rel /= count;
  return errors;
}

const std::vector<float>& Scalar(const TriangleMesh& mesh, const std::string& name) {
  const auto found =
      std::find_if(mesh.scalars.begin(), mesh.scalars.end(), [&](const auto& scalar) { return scalar.first == name; });
  EXPECT_NE(found, mesh.scalars.end()) << name;
  return found->second;
}

TEST(Refine, BringsADentedSeedToTheTrueSurface) {
  const Problem p = MakeProblem();
  RefineOptions options = FastOptions();
  const RefineResult with = Refine(p.Input(), options);
  options.use_highlights = false;
  const RefineResult without = Refine(p.Input(), options);
  const Errors good = NearContacts(p, with.mesh), smooth = NearContacts(p, without.mesh);
  RecordProperty("normal_deg", std::to_string(good.normal_deg));
  EXPECT_LT(good.normal_deg, 1.0);
  EXPECT_LT(good.distance_rel, 0.001);
  EXPECT_GT(smooth.normal_deg, 3 * good.normal_deg);
  EXPECT_GE(with.summary.num_contacts, static_cast<int>(p.highlights.size()) - 4);
  EXPECT_EQ(without.summary.num_contacts, 0);
}

// A light that is off by an unknown degree turns all its normals: no number of highlights helps against that.
TEST(Refine, AnUncertainLightMakesNormalsUncertain) {
  Problem problem = MakeProblem();
  RefineOptions options = FastOptions();
  options.lights = "fixed";
  const RefineResult sure = Refine(problem.Input(), options);
  for (Light& light : problem.lights) light.sigma = 4;
  const RefineResult unsure = Refine(problem.Input(), options);
  std::vector<float> a = Scalar(sure.mesh, "sigma_normal_deg"), b = Scalar(unsure.mesh, "sigma_normal_deg");
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  // Where they pass; half of 4 degrees is what the half vector turns by, in both directions across the normal.
  EXPECT_LT(a[a.size() / 10], 1);
  EXPECT_GT(b[b.size() / 10], 1);
}

// The normals where highlights pass are within twice the standard deviation that is stated there, mostly.
TEST(Refine, StandardDeviationsAreHonest) {
  const Problem p = MakeProblem();
  const TriangleMesh mesh = Refine(p.Input(), FastOptions()).mesh;
  const std::vector<float>& sigma_deg = Scalar(mesh, "sigma_normal_deg");
  int inside = 0, count = 0;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Eigen::Vector3d& x = mesh.vertices[v];
    if (!std::any_of(p.contact_positions.begin(), p.contact_positions.end(),
                     [&](const Eigen::Vector3d& c) { return (c - x).norm() < 0.03; }))
      continue;
    const Eigen::Vector3d normal = x.cwiseQuotient(p.shape.radii.cwiseAbs2()).normalized();
    const double off_deg = std::acos(std::min(1.0, normal.dot(mesh.normals[v]))) * 180 / M_PI;
    inside += off_deg < 2 * sigma_deg[v];
    ++count;
  }
  ASSERT_GT(count, 100);
  EXPECT_GT(inside, 0.88 * count);
}

TEST(Refine, EveryStepLowersItsEnergy) {
  const Problem p = MakeProblem();
  const RefineResult result = Refine(p.Input(), FastOptions());
  ASSERT_FALSE(result.summary.iterations.empty());
  for (const IterationSummary& iteration : result.summary.iterations) {
    EXPECT_LE(iteration.step.energy_after, iteration.step.energy_before * (1 + 1e-9));
    EXPECT_LE(iteration.bundle.final_cost, iteration.bundle.initial_cost * (1 + 1e-9));
  }
}

TEST(Refine, IsEquivariantUnderScaleAndTranslation) {
  const Problem unit = MakeProblem();
  RefineOptions options = FastOptions();
  options.voxel_rel *= 2;
  const RefineResult a = Refine(unit.Input(), options);
  const Errors expected = NearContacts(unit, a.mesh);
  for (double scale : {1e-6, 1e6}) {
    const Eigen::Vector3d offset = scale * Eigen::Vector3d(3, -2, 1);
    const Problem p = MakeProblem(scale, offset);
    const RefineResult b = Refine(p.Input(), options);
    const Errors errors = NearContacts(p, b.mesh, scale, offset);
    EXPECT_NEAR(errors.normal_deg, expected.normal_deg, 0.1);
    EXPECT_EQ(b.level_set.empty(), scale < 1);  // OpenVDB has a smallest voxel
    if (scale > 1) {
      EXPECT_NEAR(b.level_set.voxel_size() / a.level_set.voxel_size(), scale, 1e-6 * scale);
    }
  }
}

TEST(Refine, IsTheSameAtAnyNumberOfThreads) {
  const Problem p = MakeProblem();
  RefineOptions options = FastOptions();
  options.voxel_rel *= 2;
  options.levels = 1;
  std::vector<TriangleMesh> meshes;
  for (int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    meshes.push_back(Refine(p.Input(), options).mesh);
  }
  EXPECT_EQ(meshes[0].vertices, meshes[1].vertices);
  EXPECT_EQ(meshes[0].faces, meshes[1].faces);
  EXPECT_EQ(meshes[0].confidence, meshes[1].confidence);
}

TEST(Refine, SolvesForALightThatIsOff) {
  Problem p = MakeProblem();
  const std::vector<Light> truth = p.lights;
  p.lights = {DistantLight(1.15, 0.1, 0.95), DistantLight(-0.75, 0.6, 1.05)};
  for (Light& light : p.lights) light.sigma = 10;
  RefineOptions options = FastOptions();
  options.max_iterations = 8;  // surface and lights creep towards each other
  const RefineResult result = Refine(p.Input(), options);
  for (size_t k = 0; k < truth.size(); ++k)
    EXPECT_LT(std::acos(result.lights[k].vector.dot(truth[k].vector)) * 180 / M_PI, 1.0);
}

TEST(Refine, WithoutAnyKnowledgeTheSeedStays) {
  Problem p = MakeProblem();
  p.highlights.clear();
  p.point_used.clear();
  const RefineResult result = Refine(p.Input(), FastOptions());
  EXPECT_NEAR(SignedVolume(result.mesh) / SignedVolume(p.seed), 1, 0.01);
}

}  // namespace
}  // namespace glint
