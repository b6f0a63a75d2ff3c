#include "refine/level_set_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel.h"
#include "core/square.h"
#include "refine/band_system.h"
#include "refine/explained.h"
#include "refine/gaps.h"

namespace glint {

void LevelSetOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "smoothness", .help = "weight of the squared Hessian over the surface", .min = 1e-6, .max = 1e6},
          smoothness);
  v.Field({.name = "smoothness_length_rel",
           .help = "longer than this, changes of the bend weigh more than the bend itself; 0: only the bend does",
           .unit = "fraction of the diagonal",
           .min = 0,
           .max = 10},
          smoothness_length_rel);
  v.Field({.name = "normal_weight",
           .help = "weight that keeps the field a distance along its normals",
           .min = 0,
           .max = 1e6},
          normal_weight);
  v.Field({.name = "seed_sigma_rel",
           .help = "how far the seed is trusted where no highlight and no point says otherwise",
           .unit = "fraction of the diagonal",
           .min = 1e-5,
           .max = 1},
          seed_sigma_rel);
  v.Field({.name = "seed_length_rel",
           .help = "distance over which the seed's errors are alike; more in wide gaps between what is known",
           .unit = "fraction of the diagonal",
           .min = 1e-3,
           .max = 1},
          seed_length_rel);
  v.Field({.name = "point_weight", .help = "weight of the sparse points; 0: not used", .min = 0, .max = 1e4},
          point_weight);
  v.Field({.name = "highlight_weight", .help = "weight of the highlights; 0: not used", .min = 0, .max = 1e4},
          highlight_weight);
  v.Field({.name = "outline_weight",
           .help = "weight of the object's outlines, whose next places err alike; 0: not used",
           .min = 0,
           .max = 1e4},
          outline_weight);
  v.Field({.name = "reweightings", .help = "solves with weights of outliers lowered", .min = 1, .max = 20},
          reweightings);
  v.Field({.name = "max_iterations", .help = "of the linear solver", .min = 1, .max = 100000}, max_iterations);
  v.Field({.name = "tolerance", .help = "relative residual at which the linear solver stops", .min = 1e-12, .max = 0.5},
          tolerance);
}

namespace {

// Where the voxels do not carry more than the seed, it is held to a quarter of one.
constexpr double kHeldSigmaVoxels = 0.25, kHeldLengthVoxels = 2;
// In a gap between known places the seed is one guess, wrong all over it in one direction: errors are alike over three
// times the way to the next place, up to this. But it does not go below the foot: what the foot's rim turns by would
// swing a flat one far into the ground.
constexpr double kGapLengths = 3, kWidestGap = 0.1, kFootLength = 0.5;

}  // namespace

BandWeights StepWeights(const Band& band, const StepInput& input, const LevelSetOptions& options) {
  const double h = band.voxel_size();
  const double area = input.surface_area / static_cast<double>(band.size());  // a voxel's share of the surface integral
  BandWeights weights;
  weights.smoothness = options.smoothness * area / std::pow(h, 4);
  weights.bend_change = weights.smoothness * Square(options.smoothness_length_rel / h);
  weights.normal = options.normal_weight * area / (h * h);
  weights.n.resize(band.size());
  weights.pull.resize(band.size());
  weights.pull_target.resize(band.size());
  if (input.bend != Bend::kFlat) weights.reference.resize(band.size());
  static const std::vector<OrientedPoint> kNone;
  const std::vector<OrientedPoint>& contacts = options.highlight_weight > 0 ? input.contacts : kNone;
  const Explained explained(contacts);
  static const std::vector<SurfacePoint> kNoPoints;
  const Gaps gaps(options.point_weight > 0 ? input.points : kNoPoints, contacts,
                  options.outline_weight > 0 ? input.outline : kNone);
  const double held = 1 / Square(kHeldSigmaVoxels * kHeldLengthVoxels * h * h);
  const double background = input.seed.half_width_voxels() * input.seed.voxel_size();
  ParallelFor(band.size(), 1 << 12, [&](size_t i) {
    const Eigen::Vector3d x = band.Position(i);
    const Eigen::Vector3d g = input.surface.Gradient(x);
    const double length = g.norm();
    const Eigen::Vector3d normal = length > 1e-12 ? Eigen::Vector3d(g / length) : Eigen::Vector3d::Zero();
    weights.n[i] = normal.cast<float>();
    const bool hold = input.unresolved && input.unresolved->Near(x);
    const double value = input.seed.Value(x);
    double alike = std::max(options.seed_length_rel, kGapLengths * gaps.At(x, normal, kWidestGap));
    if (alike > options.seed_length_rel && input.foot && input.surface.Value(x) < value && input.foot->At(x, normal))
      alike = kFootLength * options.seed_length_rel;
    const double mu = 1 / Square(options.seed_sigma_rel * alike);
    // m of DESIGN 3.4: near 1 where no contact reaches, near 0 where one does.
    const double pull = hold ? held : mu * static_cast<float>(1 - explained.At(x, normal));
    const bool known = std::abs(value) < background - 2 * h;
    weights.pull[i] = known ? static_cast<float>(area * pull) : 0;
    weights.pull_target[i] = static_cast<float>(value);
    if (input.bend != Bend::kFlat)
      weights.reference[i] = !known ? std::numeric_limits<float>::quiet_NaN()
                             : hold ? static_cast<float>(value)
                                    // Averaged, so that the facets of its mesh are not taken for bends.
                                    : static_cast<float>(input.seed.MeanValue(x));
  });
  return weights;
}

SurfaceConstraints StepConstraints(const Band& band, const StepInput& input, const LevelSetOptions& options) {
  SurfaceConstraints constraints(band);
  constraints.AddContacts(input.contacts, options.highlight_weight);
  constraints.AddPoints(input.points, options.point_weight);
  constraints.AddOutline(input.outline, options.outline_weight);
  constraints.AddTilts(input.tilts);
  return constraints;
}

LevelSet VariationalStep(const StepInput& input, const LevelSetOptions& options, StepSummary* summary) {
  StepSummary local;
  StepSummary& report = summary ? *summary : local;
  report = {};
  const Band band(input.surface);
  report.num_voxels = band.size();
  const SurfaceConstraints constraints = StepConstraints(band, input, options);
  report.contacts_off_band = constraints.contacts_off_band();
  report.points_off_band = constraints.points_off_band();
  BandSystem system(band, StepWeights(band, input, options), constraints.rows());
  std::vector<double> phi(band.phi().begin(), band.phi().end());
  const auto solve = [&](std::vector<double>& field) {
    const SolveReport solved = system.Solve(options.max_iterations, options.tolerance, field);
    report.solver_iterations += solved.iterations;
    return solved;
  };
  SolveReport solved;
  // The first solve trusts every contact: the seed is no judge of them, while the points have made it.
  for (int k = 0; k < options.reweightings; ++k) {
    system.SetRowWeights(constraints.RobustWeights(phi, k == 0));
    solved = solve(phi);
    if (k == 0) report.energy_before = solved.initial_energy;
  }
  report.bends_like_seed = input.bend != Bend::kFlat;
  if (input.bend == Bend::kEither) {
    // Under the weights that the other ended with, so that the two energies are of one problem.
    std::vector<double> flat = phi;
    system.SetReference({});
    const SolveReport solved_flat = solve(flat);
    if (solved_flat.final_energy < solved.final_energy) {
      report.bends_like_seed = false;
      phi = std::move(flat);
      solved = solved_flat;
      for (int k = 1; k < options.reweightings; ++k) {
        system.SetRowWeights(constraints.RobustWeights(phi, false));
        solved = solve(phi);
      }
    }
  }
  report.energy_after = solved.final_energy;
  report.relative_residual = solved.relative_residual;
  return band.WithValues(std::vector<float>(phi.begin(), phi.end()));
}

}  // namespace glint
