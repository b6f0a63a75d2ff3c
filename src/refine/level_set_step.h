// One step of the level set for fixed contacts: the minimum over the band of
//   α Σ ρ(‖∇φ(xᵢ) − nᵢ‖²/σₙ²) + Σ ρ(φ(bᵢ)²/σᵢ²) + Σ ρ(φ(pⱼ)²/σⱼ²) + γ ∫‖Hψ‖² + γ λ² ∫‖∇Hψ‖² + η ∫(∂φ/∂n − 1)²
//   + μ ∫ m (φ − φ₀)²,  ψ = φ − φ₀ or φ
// (DESIGN 3.4, "variational"; bending may be measured against the seed φ₀, and its change counts too). Integrals are
// over the surface, so that weights do not depend on the voxel size.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/options.h"
#include "refine/band_system.h"
#include "refine/bundle.h"
#include "sdf/level_set.h"

namespace glint {

struct LevelSetOptions {
  double smoothness = 30;
  double smoothness_length_rel = 0.06;
  double normal_weight = 10;
  double seed_sigma_rel = 0.01;
  double seed_length_rel = 0.06;
  double point_weight = 1;
  double highlight_weight = 1;
  int reweightings = 2;
  int max_iterations = 200;
  double tolerance = 0.05;
  void Visit(OptionVisitor& v);
};

// A place where the surface's position and normal are known. Lengths in units of the object's diagonal.
struct OrientedPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // on the current surface: where the normal holds
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  Eigen::Vector3d bundle_position = Eigen::Vector3d::Zero();  // where the bundle has it
  double sigma_position = 0;                                  // of the latter, across the surface; 0: not known
  double sigma_normal = 0;                                    // radians
  double reach = 0;  // radius within which it explains the surface, so that the seed need not be kept
};

struct StepSummary {
  double energy_before = 0;
  double energy_after = 0;
  int solver_iterations = 0;
  double relative_residual = 0;
  size_t num_voxels = 0;
  int contacts_off_band = 0;
  int points_off_band = 0;
};

// `surface`: the current surface as a signed distance field; `seed`: the field to stay near where nothing is known
// (its band should be the wider one; off it there is no pull); `bend_like_seed`: ψ = φ − φ₀, else ψ = φ. With fixed
// constraints that choice moves the mean of the prior alone, so the one with the lower energy has the more evidence.
// All in units of the object's diagonal.
LevelSet VariationalStep(const LevelSet& surface, const LevelSet& seed, bool bend_like_seed, double surface_area,
                         const std::vector<OrientedPoint>& contacts, const std::vector<SurfacePoint>& points,
                         const LevelSetOptions& options, StepSummary* summary);

}  // namespace glint
