#include "light/light_starts.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace glint {
namespace {

constexpr size_t kGridDirections = 3000;  // about 4 degrees apart

// Points spread evenly over the sphere (Fibonacci lattice).
std::vector<Eigen::Vector3d> DirectionGrid() {
  std::vector<Eigen::Vector3d> grid;
  const double golden = M_PI * (3 - std::sqrt(5.0));
  for (size_t i = 0; i < kGridDirections; ++i) {
    const double z = 1 - 2 * (i + 0.5) / kGridDirections, r = std::sqrt(1 - z * z);
    grid.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
  }
  return grid;
}

}  // namespace

std::vector<Light> LikelyDirections(const std::vector<LightObservation>& observations, const Eigen::VectorXd& weights,
                                    LightFrame frame, double max_incidence_deg, double sigma, int count) {
  std::vector<Light> starts;
  const std::vector<Eigen::Vector3d> grid = DirectionGrid();
  std::vector<double> scores(grid.size(), 0);
  ParallelFor(grid.size(), 64, [&](size_t g) {
    const Light light{LightType::kDistant, frame, grid[g], 0};
    for (size_t i = 0; i < observations.size(); ++i) {
      if (weights[i] < 0.05) continue;
      const double e = Disagreement(observations[i], light, max_incidence_deg) / sigma;
      scores[g] += weights[i] * std::exp(-0.5 * e * e);
    }
  });
  std::vector<size_t> order(grid.size());
  for (size_t g = 0; g < order.size(); ++g) order[g] = g;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return scores[a] > scores[b]; });
  std::vector<size_t> chosen;
  for (size_t g : order) {
    if (static_cast<int>(chosen.size()) == count) break;
    const bool apart = std::all_of(chosen.begin(), chosen.end(),
                                   [&](size_t c) { return grid[c].dot(grid[g]) < std::cos(2.5 * sigma); });
    if (!apart) continue;
    chosen.push_back(g);
    starts.push_back({LightType::kDistant, frame, grid[g], 0});
  }
  return starts;
}

Light AtDistance(const std::vector<LightObservation>& observations, const Light& distant, const Eigen::Vector3d& center,
                 double distance) {
  if (distant.frame == LightFrame::kWorld)
    return {LightType::kPoint, LightFrame::kWorld, center + distance * distant.vector, 0};
  // In the camera's frame the object lies at its mean place.
  Eigen::Vector3d in_cam = Eigen::Vector3d::Zero();
  for (const LightObservation& o : observations) in_cam += o.cam_from_world * center / observations.size();
  return {LightType::kPoint, LightFrame::kCamera, in_cam + distance * distant.vector, 0};
}

}  // namespace glint
