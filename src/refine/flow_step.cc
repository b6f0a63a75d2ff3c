#include "refine/flow_step.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "refine/band.h"
#include "sdf/rebuild.h"

namespace glint {

void FlowOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "alignment", .help = "weight of the contacts' normals", .min = 0, .max = 1e4}, alignment);
  v.Field({.name = "points", .help = "weight of the distance to the sparse points", .min = 0, .max = 1e4}, points);
  v.Field({.name = "curvature", .help = "weight of the area", .min = 0, .max = 1e4}, curvature);
  v.Field({.name = "force", .help = "weight of the bundle's displacements", .min = 0, .max = 1e4}, force);
  v.Field({.name = "kernel_share",
           .help = "standard deviation of a contact's weight: share of the way to its neighbours",
           .min = 0.05,
           .max = 2},
          kernel_share);
  v.Field({.name = "point_reach_rel",
           .help = "distances to points count up to here",
           .unit = "fraction of the diagonal",
           .min = 1e-3,
           .max = 1},
          point_reach_rel);
  v.Field({.name = "max_steps", .help = "of time, an iteration", .min = 1, .max = 100000}, max_steps);
}

namespace {

constexpr size_t kGrain = 1 << 12;
constexpr double kCfl = 0.45;
constexpr double kKernelReach = 2.5;   // standard deviations
constexpr double kDeltaVoxels = 1.5;   // half width of the smooth delta function
constexpr double kStillVoxels = 1e-4;  // of a step: the surface has come to rest

// What moves the surface, at the voxels of a band.
struct Forces {
  std::vector<float> weight;              // h
  std::vector<Eigen::Vector3f> weighted;  // h w
  std::vector<float> distance;            // d
  std::vector<float> force;               // F
};

Forces LayForces(const Band& band, const LevelSet& surface, const StepInput& input, const FlowOptions& options) {
  const size_t n = band.size();
  Forces f{std::vector<float>(n, 0), std::vector<Eigen::Vector3f>(n, Eigen::Vector3f::Zero()),
           std::vector<float>(n, static_cast<float>(options.point_reach_rel)), std::vector<float>(n, 0)};
  for (const OrientedPoint& contact : input.contacts) {
    const double sigma = std::max(options.kernel_share * contact.reach, band.voxel_size());
    // Where the bundle has the contact the field should be zero.
    const double off = contact.sigma_position > 0 ? surface.Value(contact.bundle_position) : 0;
    const double sigma_voxels = sigma / band.voxel_size();
    band.ForVoxelsInBall(contact.position, kKernelReach * sigma_voxels, [&](int32_t v, double squared) {
      const float k = static_cast<float>(std::exp(-0.5 * squared / (sigma_voxels * sigma_voxels)));
      f.weight[v] += k;
      f.weighted[v] += k * contact.normal.cast<float>();
      f.force[v] += k * static_cast<float>(-off);
    });
  }
  for (const SurfacePoint& point : input.points)
    band.ForVoxelsInBall(point.position, options.point_reach_rel / band.voxel_size(), [&](int32_t v, double squared) {
      f.distance[v] = std::min(f.distance[v], static_cast<float>(band.voxel_size() * std::sqrt(squared)));
    });
  // Where contacts are dense the weights stay at 1.
  for (size_t v = 0; v < n; ++v) {
    const float scale = f.weight[v] > 1 ? 1 / f.weight[v] : 1;
    f.weight[v] *= scale;
    f.weighted[v] *= scale;
    f.force[v] *= scale;
  }
  return f;
}

// First and second differences of the field at a voxel all of whose neighbours (diagonal ones, too) are in the band.
struct Stencil {
  Eigen::Vector3d forward, backward, central;
  double curvature_times_gradient = 0;  // κ |∇φ|

  static bool Take(const Band& band, const std::vector<float>& phi, size_t i, Stencil& s) {
    const double h = band.voxel_size();
    const double here = phi[i];
    Eigen::Matrix3d second;
    for (int a = 0; a < 3; ++a) {
      const int32_t minus = band.Neighbor(i, a, 0), plus = band.Neighbor(i, a, 1);
      if (minus == Band::kNone || plus == Band::kNone) return false;
      s.forward[a] = (phi[plus] - here) / h;
      s.backward[a] = (here - phi[minus]) / h;
      s.central[a] = 0.5 * (s.forward[a] + s.backward[a]);
      second(a, a) = (s.forward[a] - s.backward[a]) / h;
    }
    for (int a = 0; a < 3; ++a)
      for (int b = a + 1; b < 3; ++b) {
        double sum = 0;
        for (int side_a = 0; side_a < 2; ++side_a)
          for (int side_b = 0; side_b < 2; ++side_b) {
            const int32_t v = band.Diagonal(i, a, side_a, b, side_b);
            if (v == Band::kNone) return false;
            sum += (side_a == side_b ? 1 : -1) * static_cast<double>(phi[v]);
          }
        second(a, b) = second(b, a) = sum / (4 * h * h);
      }
    const double squared = s.central.squaredNorm();
    // Where two fronts meet there is no normal, but both still move.
    s.curvature_times_gradient = squared > 1e-12 ? second.trace() - s.central.dot(second * s.central) / squared : 0;
    return true;
  }

  // V·∇φ, upwind for the advection φ_t + V·∇φ = 0.
  double Advected(const Eigen::Vector3d& velocity) const {
    double sum = 0;
    for (int a = 0; a < 3; ++a) sum += velocity[a] * (velocity[a] > 0 ? backward[a] : forward[a]);
    return sum;
  }

  // |∇φ| for the motion φ_t = speed |∇φ|, Godunov's.
  double Gradient(double speed) const {
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
      const double inflow = speed > 0 ? std::max(std::max(forward[a], 0.0), std::max(-backward[a], 0.0))
                                      : std::max(std::max(backward[a], 0.0), std::max(-forward[a], 0.0));
      sum += inflow * inflow;
    }
    return std::sqrt(sum);
  }
};

// The flow on one band, until the surface may have moved too far for it.
class BandFlow {
 public:
  BandFlow(const LevelSet& surface, const StepInput& input, const FlowOptions& options)
      : band_(surface), options_(options), forces_(LayForces(band_, surface, input, options)), phi_(band_.phi()) {
    const double h = band_.voxel_size();
    const double rate = ParallelMax([&](size_t i) {
      const Motion m = MotionAt(i);
      return 6 * m.diffusion / (h * h) + (m.velocity.lpNorm<1>() + 3 * std::abs(m.speed)) / h;
    });
    time_step_ = rate > 0 ? kCfl / rate : 0;
  }

  // ∫ h (1 − n·w), over the surface.
  double AlignmentEnergy() const {
    const double h = band_.voxel_size(), width = kDeltaVoxels * h;
    return ParallelSum(band_.size(), kGrain, 0.0, [&](size_t begin, size_t end) {
      double sum = 0;
      for (size_t i = begin; i < end; ++i) {
        Stencil s;
        if (forces_.weight[i] == 0 || std::abs(phi_[i]) > width || !Stencil::Take(band_, phi_, i, s)) continue;
        const double delta = (1 + std::cos(M_PI * phi_[i] / width)) / (2 * width);
        const double off = forces_.weight[i] * s.central.norm() - forces_.weighted[i].cast<double>().dot(s.central);
        sum += delta * off * h * h * h;
      }
      return sum;
    });
  }

  // Returns the largest motion, in voxels.
  double Advance() {
    std::vector<float> next(phi_);
    const double moved = ParallelMax([&](size_t i) {
      const double rate = Rate(i);
      next[i] = static_cast<float>(phi_[i] + time_step_ * rate);
      return std::abs(time_step_ * rate);
    });
    phi_.swap(next);
    return moved / band_.voxel_size();
  }

  LevelSet Surface() const { return band_.WithValues(phi_); }
  size_t size() const { return band_.size(); }

 private:
  template <class Value>
  double ParallelMax(const Value& value) const {
    struct Largest {
      double at_most = 0;
      Largest& operator+=(const Largest& other) {
        at_most = std::max(at_most, other.at_most);
        return *this;
      }
    };
    return ParallelSum(band_.size(), kGrain, Largest{},
                       [&](size_t begin, size_t end) {
                         Largest largest;
                         for (size_t i = begin; i < end; ++i) largest.at_most = std::max(largest.at_most, value(i));
                         return largest;
                       })
        .at_most;
  }

  // φ_t = diffusion κ |∇φ| − velocity·∇φ + speed |∇φ|
  struct Motion {
    double diffusion = 0, speed = 0;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  };

  Motion MotionAt(size_t i) const {
    Motion m;
    double divergence = 0;
    for (int a = 0; a < 3; ++a) {
      const int32_t minus = band_.Neighbor(i, a, 0), plus = band_.Neighbor(i, a, 1);
      if (minus == Band::kNone || plus == Band::kNone) return {};
      const double per_length = 1 / (2 * band_.voxel_size());
      divergence += per_length * (forces_.weighted[plus][a] - forces_.weighted[minus][a]);
      m.velocity[a] = -per_length * (options_.alignment * (forces_.weight[plus] - forces_.weight[minus]) +
                                     options_.points * (forces_.distance[plus] - forces_.distance[minus]));
    }
    m.speed = options_.force * forces_.force[i] - options_.alignment * divergence;
    m.diffusion = options_.alignment * forces_.weight[i] + options_.points * forces_.distance[i] + options_.curvature;
    return m;
  }

  double Rate(size_t i) const {
    Stencil s;
    if (!Stencil::Take(band_, phi_, i, s)) return 0;
    const Motion m = MotionAt(i);
    return m.diffusion * s.curvature_times_gradient - s.Advected(m.velocity) + m.speed * s.Gradient(m.speed);
  }

  Band band_;
  const FlowOptions& options_;
  Forces forces_;
  std::vector<float> phi_;
  double time_step_ = 0;
};

}  // namespace

LevelSet FlowStep(const StepInput& input, const FlowOptions& options, StepSummary* summary) {
  StepSummary local;
  StepSummary& report = summary ? *summary : local;
  report = {};
  LevelSet surface = input.surface;
  bool at_rest = false;
  while (report.solver_iterations < options.max_steps && !at_rest) {
    BandFlow flow(surface, input, options);
    report.num_voxels = flow.size();
    if (report.solver_iterations == 0) report.energy_before = flow.AlignmentEnergy();
    for (double moved = 0; moved < 0.5 && report.solver_iterations < options.max_steps && !at_rest;) {
      const double step = flow.Advance();
      moved += step;
      at_rest = step < kStillVoxels;
      ++report.solver_iterations;
    }
    report.energy_after = flow.AlignmentEnergy();
    surface = Redistance(flow.Surface(), input.surface.half_width_voxels());
  }
  return surface;
}

}  // namespace glint
