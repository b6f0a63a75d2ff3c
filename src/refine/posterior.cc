#include "refine/posterior.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/random_bits.h"
#include "refine/band_system.h"

namespace glint {
namespace {

constexpr int kSamples = 24;
// A sample need not be exact: it is noise.
constexpr double kSampleTolerance = 0.1;
constexpr size_t kGrain = 1 << 12;
constexpr float kUnknownNormal = static_cast<float>(20 * M_PI / 180);

// A vector of sums of coins a light: near enough to normal for what is only squared and summed.
std::vector<Eigen::Vector3d> StandardNormals(uint64_t seed, size_t count) {
  std::vector<Eigen::Vector3d> out(count);
  for (size_t i = 0; i < count; ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const uint64_t bits = RandomBits(seed, 3 * i + axis);
      // Twelve bits that are 0 or 1 have a mean of 6 and a variance of 3.
      int sum = 0;
      for (int k = 0; k < 12; ++k) sum += static_cast<int>(bits >> k & 1);
      out[i][axis] = (sum - 6) / std::sqrt(3.0);
    }
  return out;
}

// Of one voxel or place, a value of each sample.
using Samples = Eigen::Array<float, kSamples, 1>;

// Standard deviations at a place whose normal is n: of the samples' values, and of their gradients across n. False
// where a voxel is missing.
bool Spread(const Band& band, const std::vector<Samples>& deviations, const Eigen::Vector3d& x,
            const Eigen::Vector3f& n, float& position, float& normal) {
  std::array<int32_t, 8> voxels;
  std::array<double, 8> weights;
  if (!band.Trilinear(x, voxels, weights)) return false;
  Samples value = Samples::Zero();
  std::array<Samples, 3> gradient = {value, value, value};
  for (int k = 0; k < 8; ++k) {
    if (!band.HasAllNeighbors(voxels[k])) return false;
    const auto weight = static_cast<float>(weights[k]);
    value += weight * deviations[voxels[k]];
    for (int axis = 0; axis < 3; ++axis)
      gradient[axis] +=
          weight * (deviations[band.Neighbor(voxels[k], axis, 1)] - deviations[band.Neighbor(voxels[k], axis, 0)]);
  }
  const Samples along = n[0] * gradient[0] + n[1] * gradient[1] + n[2] * gradient[2];
  float across = 0;
  for (int axis = 0; axis < 3; ++axis) across += (gradient[axis] - n[axis] * along).square().mean();
  position = std::sqrt(value.square().mean());
  normal = std::sqrt(across) / static_cast<float>(2 * band.voxel_size());
  return true;
}

// Where the bundle has the contacts follows from the same normals and points: counted again, as independent of each
// other, it would promise more than is known.
std::vector<OrientedPoint> NormalsAlone(std::vector<OrientedPoint> contacts) {
  for (OrientedPoint& contact : contacts) contact.sigma_position = 0;
  return contacts;
}

}  // namespace

SurfaceDeviation PosteriorDeviation(const StepInput& input, const LevelSetOptions& options,
                                    const std::vector<Eigen::Vector3d>& at) {
  const Band band(input.surface);
  const std::vector<OrientedPoint> contacts = NormalsAlone(input.contacts);
  const StepInput measured{input.surface, input.seed,    input.bend,  input.surface_area, contacts,
                           input.points,  input.outline, input.tilts, input.unresolved};
  const SurfaceConstraints constraints = StepConstraints(band, measured, options);
  BandSystem system(band, StepWeights(band, measured, options), constraints.rows());
  const std::vector<double> phi(band.phi().begin(), band.phi().end());
  system.SetRowWeights(constraints.RobustWeights(phi, false));

  size_t num_lights = 0;
  for (const OrientedPoint& contact : input.contacts)
    num_lights = std::max(num_lights, static_cast<size_t>(contact.light + 1));
  std::vector<Samples> deviations(band.size());
  for (int sample = 0; sample < kSamples; ++sample) {
    const uint64_t seed = static_cast<uint64_t>(sample) << 32;
    const std::vector<double> noise = constraints.LightNoise(input.contacts, StandardNormals(~seed, num_lights));
    const std::vector<double> deviation = system.Deviation(seed, noise, options.max_iterations, kSampleTolerance);
    for (size_t i = 0; i < deviation.size(); ++i) deviations[i][sample] = static_cast<float>(deviation[i]);
  }
  SurfaceDeviation out{std::vector<float>(at.size(), static_cast<float>(options.seed_sigma_rel)),
                       std::vector<float>(at.size(), kUnknownNormal)};
  ParallelFor(at.size(), kGrain, [&](size_t i) {
    const Eigen::Vector3d g = input.surface.Gradient(at[i]);
    if (g.norm() <= 0.5) return;
    Spread(band, deviations, at[i], g.normalized().cast<float>(), out.position[i], out.normal[i]);
  });
  return out;
}

}  // namespace glint
