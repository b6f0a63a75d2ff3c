#include "refine/refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/check.h"
#include "geometry/components.h"
#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"
#include "refine/confidence.h"
#include "refine/highlight_contacts.h"
#include "refine/known_places.h"
#include "refine/normalized.h"
#include "refine/thickness.h"
#include "sdf/extract_mesh.h"
#include "sdf/mesh_to_level_set.h"
#include "sdf/rebuild.h"
#include "seed/build_seed.h"
#include "seed/foot.h"

namespace glint {

namespace {

constexpr double kRadians = M_PI / 180;
// Beyond the band and the way from the seed: for differences, and for what the step itself will move.
constexpr double kSeedMarginVoxels = 5;
constexpr double kMaxWayVoxels = 24;  // for memory's sake
// Standard deviations change slowly over the surface.
constexpr double kConfidenceVoxelRel = 1.0 / 64;
constexpr double kVoxelsAWall = 3;  // to carry it
// Pieces of the extracted surface with a smaller share of its area are crumbs of the band.
constexpr double kMinPieceShare = 0.005;

TriangleMesh WithoutCrumbs(const TriangleMesh& mesh) {
  const Components pieces = FindComponents(mesh, BuildEdgeTopology(mesh));
  if (pieces.list.size() < 2) return mesh;
  std::vector<double> area(pieces.list.size());
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    const Eigen::Vector3i& face = mesh.faces[f];
    const Eigen::Vector3d& a = mesh.vertices[face[0]];
    area[pieces.of_face[f]] += 0.5 * (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a).norm();
  }
  const double total = std::accumulate(area.begin(), area.end(), 0.0);
  TriangleMesh kept = mesh;
  kept.faces.clear();
  for (size_t f = 0; f < mesh.faces.size(); ++f)
    if (area[pieces.of_face[f]] >= kMinPieceShare * total) kept.faces.push_back(mesh.faces[f]);
  return WithoutUnusedVertices(kept);
}

// All of the state between iterations, in units of the object's diagonal.
class Refiner {
 public:
  Refiner(const RefineInput& input, const RefineOptions& options, Progress& progress)
      : input_(input),
        options_(options),
        progress_(progress),
        frame_(UnitFrame::Of(input.seed)),
        highlights_(MakeHighlights()),
        tilts_(input.scene, input.lights.empty() ? nullptr : input.images, input.normals, options.tilts, frame_,
               progress),
        known_(input, options, frame_, progress),
        seed_(UnitSeed()),
        foot_(seed_, SeedScalar(kFootScalar)),
        surface_(seed_) {
    const std::vector<float> fine = SeedScalar(kFineScalar);
    for (size_t v = 0; v < fine.size(); ++v)
      if (fine[v] > 0) fine_.push_back(seed_.vertices[v]);
    summary_.bends_like_seed = options.bend != "flat";
  }

  RefineResult Run() {
    RefineResult result;
    summary_.num_highlights = static_cast<int>(input_.highlights.size());
    summary_.num_points = static_cast<int>(known_.num_sparse());
    size_t steps = 0;
    const int first_level = FirstLevel();
    for (int level = first_level; level < options_.levels; ++level) steps += StepsOfIteration(level) * MaxIterations();
    progress_.Begin("refine", steps);
    for (int level = first_level; level < options_.levels; ++level) {
      const double voxel = options_.voxel_rel * std::pow(2.0, options_.levels - 1 - level);
      const bool finished = RunLevel(voxel, StepsOfIteration(level));
      if (level + 1 == options_.levels) summary_.converged = finished;
    }
    Finish(result);
    return result;
  }

 private:
  HighlightContacts MakeHighlights() const;
  TriangleMesh UnitSeed() const;
  // A scalar of the seed's vertices; empty if it has none of that name.
  std::vector<float> SeedScalar(const std::string& name) const;
  // Four times the surface takes four times as long: the steps of progress are weighed so.
  static size_t StepsOfIteration(int level) { return size_t{1} << (2 * level); }
  int FirstLevel();
  size_t MaxIterations() const { return static_cast<size_t>(options_.max_iterations); }
  bool RunLevel(double voxel, size_t progress_steps);
  LevelSet SeedField(double voxel, double half_width_voxels);
  LevelSet Step(const LevelSet& seed_field, bool undecided, StepSummary& summary);
  void TakeSurface(const LevelSet& stepped, const SdfOptions& sdf);
  void MeasureConfidence();
  void Finish(RefineResult& result);

  const RefineInput& input_;
  const RefineOptions& options_;
  Progress& progress_;
  const UnitFrame frame_;
  HighlightContacts highlights_;
  PhotoTilts tilts_;
  KnownPlaces known_;
  const TriangleMesh seed_;
  const FootPlaces foot_;
  TriangleMesh surface_;
  LevelSet field_;  // of the surface; empty before the first step
  LevelSet seed_field_;
  int steps_left_out_ = 0;
  double way_from_seed_ = 0;           // the largest of the surface's vertices so far
  std::vector<Eigen::Vector3d> fine_;  // of the seed, finer than it is elsewhere
  RefineSummary summary_;
};

// The coarsest level whose voxels carry the seed's walls; coarser ones would lose them.
int Refiner::FirstLevel() {
  if (fine_.empty()) return 0;
  const double thinnest = ThinnestWalls(seed_);
  int level = 0;
  while (level + 1 < options_.levels &&
         kVoxelsAWall * options_.voxel_rel * std::pow(2.0, options_.levels - 1 - level) > thinnest)
    ++level;
  if (kVoxelsAWall * options_.voxel_rel > thinnest)
    summary_.warnings.push_back(
        fmt::format("some walls are {:.2g} of the diagonal thick, which voxels of {:.2g} hardly carry: give "
                    "--set refine.voxel_rel={:.2g}",
                    thinnest, options_.voxel_rel, thinnest / kVoxelsAWall));
  return level;
}

TriangleMesh Refiner::UnitSeed() const {
  TriangleMesh seed = frame_.FromWorld(TriangleMesh{input_.seed.vertices, input_.seed.faces, {}, {}, {}, {}});
  seed.normals = ComputePseudoNormals(seed, BuildEdgeTopology(seed)).vertex;
  return seed;
}

std::vector<float> Refiner::SeedScalar(const std::string& name) const {
  for (const auto& [scalar, values] : input_.seed.scalars)
    if (scalar == name) return values;
  return {};
}

HighlightContacts Refiner::MakeHighlights() const {
  std::vector<Light> lights;
  std::vector<bool> solve;
  for (const Light& light : input_.lights) {
    lights.push_back(frame_.FromWorld(light));
    solve.push_back(options_.lights == "solve" || (options_.lights == "auto" && light.sigma > 0));
  }
  std::vector<Contact> contacts;
  if (options_.use_highlights)
    for (const Contact& contact : MakeContacts(input_.scene, input_.highlights, options_.contacts))
      contacts.push_back(frame_.FromWorld(contact));
  return {std::move(contacts), std::move(lights), std::move(solve), options_.use_lobes};
}

// A faired seed bends much as the object does, a raw mesh is rough: the first step of each level
// tells which it is, at the roughness that its voxels resolve. Coarser ones cannot tell for it.
LevelSet Refiner::Step(const LevelSet& seed_field, bool undecided, StepSummary& summary) {
  const Unresolved unresolved(surface_, field_, fine_);
  std::vector<OrientedPoint> contacts = highlights_.Oriented();
  std::erase_if(contacts, [&](const OrientedPoint& p) { return unresolved.Near(p.position); });
  std::vector<Tilt> tilts = tilts_.tilts();
  std::erase_if(tilts, [&](const Tilt& t) { return unresolved.Near(t.position); });
  const std::vector<OrientedPoint> outline = known_.Outline(field_);
  const double area = SurfaceArea(surface_);
  if (options_.method == "flow")
    return FlowStep({field_, seed_field, Bend::kFlat, area, contacts, known_.points(), outline, tilts, &unresolved},
                    options_.flow, &summary);
  const Bend bend = !summary_.bends_like_seed              ? Bend::kFlat
                    : undecided && options_.bend == "auto" ? Bend::kEither
                                                           : Bend::kLikeSeed;
  LevelSet stepped =
      VariationalStep({field_, seed_field, bend, area, contacts, known_.points(), outline, tilts, &unresolved, &foot_},
                      options_.level_set, &summary);
  summary_.bends_like_seed = summary.bends_like_seed;
  return stepped;
}

// True distances again, from the smooth zero set: from a mesh its facets would show in the normals.
void Refiner::TakeSurface(const LevelSet& stepped, const SdfOptions& sdf) {
  const TriangleMesh extracted = ExtractMesh(stepped);
  TriangleMesh next = WithoutCrumbs(extracted);
  // Where it leaves its band there are holes. Then the surface stays as it is.
  if (next.faces.empty() || !EdgesBalanced(next)) {
    ++steps_left_out_;
    return;
  }
  surface_ = std::move(next);
  field_ = surface_.faces.size() == extracted.faces.size() ? Redistance(stepped, sdf.half_width_voxels)
                                                           : MeshToLevelSet(surface_, stepped.voxel_size(), sdf);
}

bool Refiner::RunLevel(double voxel, size_t progress_steps) {
  SdfOptions sdf;
  // On the coarse levels contacts may still lie a few voxels off the surface.
  sdf.half_width_voxels = options_.half_width_voxels + (voxel > 1.5 * options_.voxel_rel ? 2 : 0);
  const LevelSet seed_field = SeedField(voxel, sdf.half_width_voxels);
  if (!field_.empty()) field_ = Resample(field_, voxel, sdf.half_width_voxels);
  known_.LookForTexture(surface_, highlights_.lights());
  summary_.num_photo_points = static_cast<int>(known_.points().size() - known_.num_sparse());
  for (int k = 0; k < options_.max_iterations; ++k) {
    progress_.ThrowIfCancelled();
    const auto start = std::chrono::steady_clock::now();
    IterationSummary iteration;
    iteration.voxel_rel = voxel;
    if (field_.empty()) field_ = MeshToLevelSet(surface_, voxel, sdf);
    known_.Update(field_);
    iteration.contact_motion_voxels = highlights_.Follow(surface_, field_, !summary_.iterations.empty(),
                                                         options_.contacts.max_incidence_deg * kRadians,
                                                         known_.Anchors(field_), options_.bundle, iteration.bundle) /
                                      voxel;
    iteration.contacts_on_surface = highlights_.num_on_surface();
    tilts_.LookAgain(surface_, highlights_.lights(), !summary_.iterations.empty());
    const LevelSet stepped = Step(seed_field, k == 0, iteration.step);
    TakeSurface(stepped, sdf);
    iteration.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    summary_.iterations.push_back(iteration);
    progress_.Advance(progress_steps);
    // The very first iteration moves the contacts off the seed: what it reports says nothing about the next.
    const bool first = summary_.iterations.size() == 1;
    if (first || iteration.contact_motion_voxels >= options_.min_motion_voxels) continue;
    progress_.Advance(progress_steps * (MaxIterations() - 1 - static_cast<size_t>(k)));
    return true;
  }
  return false;
}

// The seed's distances wherever a band around the current surface is, which has left it by then.
LevelSet Refiner::SeedField(double voxel, double half_width_voxels) {
  for (const Eigen::Vector3d& v : surface_.vertices)
    if (!seed_field_.empty()) way_from_seed_ = std::max(way_from_seed_, std::abs(seed_field_.Value(v)));
  SdfOptions sdf;
  sdf.half_width_voxels = half_width_voxels + std::min(way_from_seed_ / voxel, kMaxWayVoxels) + kSeedMarginVoxels;
  seed_field_ = MeshToLevelSet(seed_, voxel, sdf);
  return seed_field_;
}

void Refiner::MeasureConfidence() {
  const double voxel = std::max(options_.voxel_rel, kConfidenceVoxelRel);
  const LevelSet seed_field = SeedField(voxel, options_.half_width_voxels + 1);
  const LevelSet field = Resample(field_, voxel, options_.half_width_voxels + 1);
  const std::vector<OrientedPoint> contacts = highlights_.Oriented(), outline = known_.Outline(field);
  const StepInput input{field,
                        seed_field,
                        summary_.bends_like_seed ? Bend::kLikeSeed : Bend::kFlat,
                        SurfaceArea(surface_),
                        contacts,
                        known_.points(),
                        outline,
                        tilts_.tilts()};
  AddConfidence(PosteriorDeviation(input, options_.level_set, surface_.vertices), surface_);
}

void Refiner::Finish(RefineResult& result) {
  MeasureConfidence();
  result.mesh = frame_.ToWorld(surface_);
  SdfOptions sdf;
  sdf.half_width_voxels = options_.half_width_voxels;
  const double voxel_world = options_.voxel_rel / frame_.scale;
  if (voxel_world >= kSmallestVoxelWorld)
    result.level_set = MeshToLevelSet(result.mesh, voxel_world, sdf);
  else
    summary_.warnings.push_back(fmt::format(
        "no signed distance field: OpenVDB can not hold voxels of {:g}; scale the project up", voxel_world));
  result.highlights = input_.highlights;
  for (const Contact& contact : highlights_.contacts()) {
    if (contact.accepted)
      result.contacts.push_back(frame_.ToWorld(contact));
    else
      result.highlights[contact.highlight].status = contact.reason;
  }
  for (const Light& light : highlights_.lights()) result.lights.push_back(frame_.ToWorld(light));
  summary_.num_contacts = static_cast<int>(result.contacts.size());
  if (!summary_.converged)
    summary_.warnings.push_back(
        fmt::format("the contacts still moved after {} iterations at the finest level", options_.max_iterations));
  if (steps_left_out_ > 0)
    summary_.warnings.push_back(
        fmt::format("{} of {} steps would have torn the surface and were not made: its walls have too few voxels, or "
                    "the highlights are not this surface's",
                    steps_left_out_, summary_.iterations.size()));
  summary_.tilts = tilts_.summary();
  result.summary = summary_;
}

}  // namespace

RefineResult Refine(const RefineInput& input, const RefineOptions& options, Progress& progress) {
  GLINT_CHECK(!input.seed.faces.empty());
  return Refiner(input, options, progress).Run();
}

}  // namespace glint
