// One step of the level set for fixed contacts: the minimum over the band of
//   α Σ ρ(‖∇φ(xᵢ) − nᵢ‖²/σₙ²) + Σ ρ(φ(bᵢ)²/σᵢ²) + Σ ρ(φ(pⱼ)²/σⱼ²) + γ ∫‖Hψ‖² + γ λ² ∫‖∇Hψ‖² + η ∫(∂φ/∂n − 1)²
//   + μ ∫ m (φ − φ₀)²,  ψ = φ − φ₀ or φ
// (DESIGN 3.4, "variational"; bending may be measured against the seed φ₀, and its change counts too). Integrals are
// over the surface, so that weights do not depend on the voxel size.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/options.h"
#include "refine/band_operator.h"
#include "refine/foot_places.h"
#include "refine/surface_constraints.h"
#include "refine/thickness.h"
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
  double outline_weight = 0.1;
  int reweightings = 2;
  int max_iterations = 200;
  double tolerance = 0.05;
  void Visit(OptionVisitor& v);
};

struct StepSummary {
  double energy_before = 0;
  double energy_after = 0;
  int solver_iterations = 0;
  double relative_residual = 0;
  size_t num_voxels = 0;
  int contacts_off_band = 0;
  int points_off_band = 0;
  bool bends_like_seed = false;
};

// What costs no bending: ψ = φ − φ₀, ψ = φ, or whichever of them the constraints speak for. With fixed constraints that
// choice moves the mean of the prior alone, so the one with the lower energy has the more evidence.
enum class Bend { kLikeSeed, kFlat, kEither };

// All in units of the object's diagonal. `surface`: the current surface as a signed distance field; `seed`: the field
// to stay near where nothing is known (its band should be the wider one; off it there is no pull).
struct StepInput {
  const LevelSet& surface;
  const LevelSet& seed;
  Bend bend = Bend::kLikeSeed;
  double surface_area = 0;
  const std::vector<OrientedPoint>& contacts;
  const std::vector<SurfacePoint>& points;
  const std::vector<OrientedPoint>& outline;  // where the surface touches rays through outlines
  inline static const std::vector<Tilt> kNoTilts = {};
  const std::vector<Tilt>& tilts = kNoTilts;  // of the normals, from shading and normal maps
  const Unresolved* unresolved = nullptr;     // where the seed is held; null: nowhere
  const FootPlaces* foot = nullptr;           // which stays on the ground or is above it; null: none
};

LevelSet VariationalStep(const StepInput& input, const LevelSetOptions& options, StepSummary* summary);

// Its parts, for who wants to know more of the minimum. What is known at single places:
SurfaceConstraints StepConstraints(const Band& band, const StepInput& input, const LevelSetOptions& options);
// Weights of the terms that every voxel has.
BandWeights StepWeights(const Band& band, const StepInput& input, const LevelSetOptions& options);

}  // namespace glint
