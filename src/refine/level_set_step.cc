#include "refine/level_set_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"

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
           .help = "distance over which the seed's errors are alike",
           .unit = "fraction of the diagonal",
           .min = 1e-3,
           .max = 1},
          seed_length_rel);
  v.Field({.name = "point_weight", .help = "weight of the sparse points; 0: not used", .min = 0, .max = 1e4},
          point_weight);
  v.Field({.name = "highlight_weight", .help = "weight of the highlights; 0: not used", .min = 0, .max = 1e4},
          highlight_weight);
  v.Field({.name = "reweightings", .help = "solves with weights of outliers lowered", .min = 1, .max = 20},
          reweightings);
  v.Field({.name = "max_iterations", .help = "of the linear solver", .min = 1, .max = 100000}, max_iterations);
  v.Field({.name = "tolerance", .help = "relative residual at which the linear solver stops", .min = 1e-12, .max = 0.5},
          tolerance);
}

namespace {

// Standard deviation of a contact's footprint: a share of the distance to the next contacts.
constexpr double kFootprintShare = 0.1;
constexpr double kLeastFootprintVoxels = 0.6;
constexpr double kFootprintReach = 2.2;  // standard deviations

// Weights of a squared residual in standard deviations. Contacts: Cauchy, they were judged in the bundle already.
// Points: Geman and McClure, which lets go of the few that lie centimetres off.
double ContactWeight(double squared) { return 1 / (1 + squared / 4); }
double PointWeight(double squared) { return 1 / ((1 + squared / 9) * (1 + squared / 9)); }

// Rows with the base weights, and which of them belong together when outliers are weighted down.
struct Constraints {
  BandRows rows;
  std::vector<double> base_weight;
  struct Group {
    size_t first, last;
    bool is_point;
  };
  std::vector<Group> groups;

  void EndGroup(size_t first, bool is_point) {
    for (size_t r = first; r < rows.size(); ++r) base_weight.push_back(rows.weight[r]);
    groups.push_back({first, rows.size(), is_point});
  }
};

bool AddValueRow(const Band& band, const Eigen::Vector3d& x, double weight, BandRows& rows) {
  std::array<int32_t, 8> voxels;
  std::array<double, 8> weights;
  if (!band.Trilinear(x, voxels, weights)) return false;
  for (int k = 0; k < 8; ++k) rows.Push(voxels[k], weights[k]);
  rows.Close(0, weight);
  return true;
}

struct Tap {
  int32_t voxel;
  double weight;
};

// Voxels of a ball about x with Gaussian weights that sum to 1; empty if none has all its neighbours.
std::vector<Tap> GaussianTaps(const Band& band, const Eigen::Vector3d& x, double sigma_voxels) {
  const Eigen::Vector3d center = band.ToIndexSpace(x);
  const double reach = kFootprintReach * sigma_voxels;
  const Eigen::Vector3i low = (center.array() - reach).ceil().cast<int>();
  const Eigen::Vector3i high = (center.array() + reach).floor().cast<int>();
  std::vector<Tap> taps;
  double sum = 0;
  for (int i = low[0]; i <= high[0]; ++i)
    for (int j = low[1]; j <= high[1]; ++j)
      for (int k = low[2]; k <= high[2]; ++k) {
        const double squared = (Eigen::Vector3d(i, j, k) - center).squaredNorm();
        if (squared > reach * reach) continue;
        const int32_t v = band.Find({i, j, k});
        if (v == Band::kNone || !band.HasAllNeighbors(v)) continue;
        taps.push_back({v, std::exp(-0.5 * squared / (sigma_voxels * sigma_voxels))});
        sum += taps.back().weight;
      }
  for (Tap& tap : taps) tap.weight /= sum;
  return taps;
}

Eigen::Vector3d GradientOf(const Band& band, const std::vector<Tap>& taps) {
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (const Tap& tap : taps)
    for (int axis = 0; axis < 3; ++axis)
      gradient[axis] +=
          tap.weight * (band.phi()[band.Neighbor(tap.voxel, axis, 1)] - band.phi()[band.Neighbor(tap.voxel, axis, 0)]);
  return gradient / (2 * band.voxel_size());
}

// The normal at a contact, as the field's mean gradient over a footprint: a gradient at a mere point costs a smooth
// field almost nothing, it would answer with a spike. What the current field's mean over the footprint differs from
// its gradient at the point is carried over, so that at convergence it is the gradient at the point that agrees.
bool AddGradientRows(const Band& band, const OrientedPoint& contact, double weight, BandRows& rows) {
  const double footprint = kFootprintShare * contact.reach / band.voxel_size();
  const std::vector<Tap> mean = GaussianTaps(band, contact.position, std::max(footprint, kLeastFootprintVoxels));
  std::array<int32_t, 8> voxels;
  std::array<double, 8> weights;
  if (mean.empty() || !band.Trilinear(contact.position, voxels, weights)) return false;
  std::vector<Tap> point;
  for (int k = 0; k < 8; ++k) {
    if (!band.HasAllNeighbors(voxels[k])) return false;
    point.push_back({voxels[k], weights[k]});
  }
  const Eigen::Vector3d target = contact.normal + GradientOf(band, mean) - GradientOf(band, point);
  for (int axis = 0; axis < 3; ++axis) {
    for (const Tap& tap : mean) {
      const double c = tap.weight / (2 * band.voxel_size());
      rows.Push(band.Neighbor(tap.voxel, axis, 1), c);
      rows.Push(band.Neighbor(tap.voxel, axis, 0), -c);
    }
    rows.Close(target[axis], weight);
  }
  return true;
}

Constraints BuildConstraints(const Band& band, const std::vector<OrientedPoint>& contacts,
                             const std::vector<SurfacePoint>& points, const LevelSetOptions& options,
                             StepSummary& summary) {
  Constraints c;
  if (options.highlight_weight > 0)
    for (const OrientedPoint& contact : contacts) {
      size_t first = c.rows.size();
      if (!AddGradientRows(band, contact, options.highlight_weight / std::pow(contact.sigma_normal, 2), c.rows)) {
        ++summary.contacts_off_band;
        continue;
      }
      c.EndGroup(first, false);
      first = c.rows.size();
      if (contact.sigma_position > 0 &&
          AddValueRow(band, contact.bundle_position, options.highlight_weight / std::pow(contact.sigma_position, 2),
                      c.rows))
        c.EndGroup(first, false);
    }
  if (options.point_weight > 0)
    for (const SurfacePoint& point : points) {
      const size_t first = c.rows.size();
      if (AddValueRow(band, point.position, options.point_weight / std::pow(point.sigma, 2), c.rows))
        c.EndGroup(first, true);
      else
        ++summary.points_off_band;
    }
  return c;
}

// m of DESIGN 3.4: near 1 where no contact reaches, near 0 where one does.
std::vector<float> SeedTrust(const Band& band, const std::vector<OrientedPoint>& contacts) {
  std::vector<float> trust(band.size(), 1);
  ParallelFor(band.size(), 1 << 12, [&](size_t i) {
    const Eigen::Vector3d x = band.Position(i);
    double explained = 0;
    for (const OrientedPoint& contact : contacts) {
      const double ratio2 = (x - contact.position).squaredNorm() / (contact.reach * contact.reach);
      if (ratio2 < 9) explained = std::max(explained, std::exp(-0.5 * ratio2 * ratio2));
    }
    trust[i] = static_cast<float>(1 - explained);
  });
  return trust;
}

// Of the seed, averaged over the next voxels (1 2 1 along each axis), so that the facets of its mesh are not taken for
// bends. Linear functions stay; what quadratic ones shift by does not bend.
float SmoothValue(const LevelSet& seed, const Eigen::Vector3d& x) {
  double sum = 0;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k)
        sum += (2 - std::abs(i)) * (2 - std::abs(j)) * (2 - std::abs(k)) *
               seed.Value(x + seed.voxel_size() * Eigen::Vector3d(i, j, k));
  return static_cast<float>(sum / 64);
}

BandWeights MakeWeights(const Band& band, const LevelSet& surface, const LevelSet& seed, bool bend_like_seed,
                        double surface_area, const std::vector<OrientedPoint>& contacts,
                        const LevelSetOptions& options) {
  const double h = band.voxel_size();
  const double area = surface_area / static_cast<double>(band.size());  // a voxel's share of the surface integral
  BandWeights weights;
  weights.smoothness = options.smoothness * area / std::pow(h, 4);
  weights.bend_change = weights.smoothness * std::pow(options.smoothness_length_rel / h, 2);
  weights.normal = options.normal_weight * area / (h * h);
  weights.n.resize(band.size());
  weights.pull.resize(band.size());
  weights.pull_target.resize(band.size());
  if (bend_like_seed) weights.reference.resize(band.size());
  static const std::vector<OrientedPoint> kNone;
  const std::vector<float> trust = SeedTrust(band, options.highlight_weight > 0 ? contacts : kNone);
  const double mu = 1 / std::pow(options.seed_sigma_rel * options.seed_length_rel, 2);
  const double background = seed.half_width_voxels() * seed.voxel_size();
  ParallelFor(band.size(), 1 << 12, [&](size_t i) {
    const Eigen::Vector3d x = band.Position(i);
    const Eigen::Vector3d g = surface.Gradient(x);
    const double length = g.norm();
    weights.n[i] = (length > 1e-12 ? Eigen::Vector3d(g / length) : Eigen::Vector3d::Zero()).cast<float>();
    const double value = seed.Value(x);
    const bool known = std::abs(value) < background - 2 * h;
    weights.pull[i] = known ? static_cast<float>(mu * area * trust[i]) : 0;
    weights.pull_target[i] = static_cast<float>(value);
    if (bend_like_seed) weights.reference[i] = known ? SmoothValue(seed, x) : std::numeric_limits<float>::quiet_NaN();
  });
  return weights;
}

}  // namespace

LevelSet VariationalStep(const LevelSet& surface, const LevelSet& seed, bool bend_like_seed, double surface_area,
                         const std::vector<OrientedPoint>& contacts, const std::vector<SurfacePoint>& points,
                         const LevelSetOptions& options, StepSummary* summary) {
  StepSummary local;
  StepSummary& report = summary ? *summary : local;
  report = {};
  const Band band(surface);
  report.num_voxels = band.size();
  Constraints constraints = BuildConstraints(band, contacts, points, options, report);
  BandSystem system(band, MakeWeights(band, surface, seed, bend_like_seed, surface_area, contacts, options),
                    constraints.rows);
  std::vector<double> phi(band.phi().begin(), band.phi().end());
  for (int k = 0; k < options.reweightings; ++k) {
    for (const auto& [first, last, is_point] : constraints.groups) {
      double squared = 0;
      for (size_t r = first; r < last; ++r) {
        const double residual = constraints.rows.Dot(r, phi) - constraints.rows.target[r];
        squared += constraints.base_weight[r] * residual * residual;
      }
      // The first solve trusts every contact: the seed is no judge of them, while the points have made it.
      const double weight = is_point ? PointWeight(squared) : (k == 0 ? 1 : ContactWeight(squared));
      for (size_t r = first; r < last; ++r) constraints.rows.weight[r] = weight * constraints.base_weight[r];
    }
    system.SetRowWeights(constraints.rows.weight);
    const SolveReport solve = system.Solve(options.max_iterations, options.tolerance, phi);
    if (k == 0) report.energy_before = solve.initial_energy;
    report.energy_after = solve.final_energy;
    report.solver_iterations += solve.iterations;
    report.relative_residual = solve.relative_residual;
  }
  return band.WithValues(std::vector<float>(phi.begin(), phi.end()));
}

}  // namespace glint
