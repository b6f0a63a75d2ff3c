#include "refine/refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

#include "constraints/point_covariance.h"
#include "core/check.h"
#include "core/median.h"
#include "geometry/components.h"
#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"
#include "geometry/ray_caster.h"
#include "refine/confidence.h"
#include "refine/lobe.h"
#include "refine/normalized.h"
#include "sdf/extract_mesh.h"
#include "sdf/mesh_to_level_set.h"
#include "sdf/rebuild.h"

namespace glint {

void RefineOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "voxel_rel",
           .help = "voxel size of the finest level",
           .unit = "fraction of the diagonal",
           .min = 1e-4,
           .max = 0.1},
          voxel_rel);
  v.Field({.name = "levels", .help = "coarse to fine; each doubles the resolution", .min = 1, .max = 8}, levels);
  v.Field({.name = "half_width_voxels", .help = "of the narrow band", .unit = "voxels", .min = 3, .max = 20},
          half_width_voxels);
  v.Field({.name = "max_iterations", .help = "of bundle and level set, a level", .min = 1, .max = 100}, max_iterations);
  v.Field({.name = "min_motion_voxels",
           .help = "a level is done when the contacts move less (median)",
           .unit = "voxels",
           .min = 0,
           .max = 10},
          min_motion_voxels);
  v.Field({.name = "min_point_sigma_rel",
           .help = "least standard deviation of a sparse point across the surface",
           .unit = "fraction of the diagonal",
           .min = 1e-6,
           .max = 0.1},
          min_point_sigma_rel);
  v.Field({.name = "use_highlights", .help = "false: points and smoothness alone, to see what the highlights add"},
          use_highlights);
  v.Field({.name = "use_lobes", .help = "the shapes of the highlights too, not only their peaks"}, use_lobes);
  v.Field(
      {.name = "bend",
       .help = "what costs no bending: seed: to bend like the seed; flat: not to bend; auto: what the constraints are "
               "better explained by",
       .choices = {"auto", "seed", "flat"}},
      bend);
  v.Field({.name = "lights",
           .help = "fixed: as given; solve: refined jointly; auto: those with a standard deviation are solved",
           .choices = {"auto", "fixed", "solve"}},
          lights);
  VisitSection(v, "contacts", "highlights as oriented rays", contacts);
  VisitSection(v, "bundle", "the specular bundle", bundle);
  VisitSection(v, "level_set", "the energy of the level set", level_set);
}

namespace {

constexpr double kRadians = M_PI / 180;
// A highlight narrower than this share of what the surface would make of the usual lobe lies elsewhere.
constexpr double kMinWidthShare = 0.45;
// Nor does one that is wider by this factor: the surface is sharper there than the highlight says.
constexpr double kMaxWidthShare = 4;
// A highlight that was left out for its size comes back only when it fits clearly, so that it does not come and go.
constexpr double kReturnMargin = 1.5;
// Standard deviation of a normal at a blob's end: the blob is not quite the lobe's.
constexpr double kLeastLobeSigma = 0.25 * kRadians;
constexpr double kLobeSigmaShare = 0.08;
// The errors of the bundle's depths are alike over whole regions, which their standard deviations do not say. Where
// points are dense they decide; far from points the bundle does.
constexpr double kBundleCaution = 3;
constexpr double kLeastBundleSigma = 0.002;
// Standard deviations change slowly over the surface.
constexpr double kConfidenceVoxelRel = 1.0 / 64;
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

// Standard deviation of the direction to the light at a contact, radians.
double DirectionSigma(const Light& light, const Contact& contact) {
  if (light.type == LightType::kDistant) return light.sigma * kRadians;
  const Eigen::Vector3d position =
      light.frame == LightFrame::kWorld ? light.vector : contact.cam_from_world.Inverse() * light.vector;
  return light.sigma / std::max((position - contact.Position()).norm(), light.sigma);
}

// All of the state between iterations, in units of the object's diagonal.
class Refiner {
 public:
  Refiner(const RefineInput& input, const RefineOptions& options, Progress& progress)
      : input_(input), options_(options), progress_(progress), frame_(UnitFrame::Of(input.seed)) {
    seed_ = frame_.FromWorld(TriangleMesh{input.seed.vertices, input.seed.faces, {}, {}, {}, {}});
    seed_.normals = ComputePseudoNormals(seed_, BuildEdgeTopology(seed_)).vertex;
    surface_ = seed_;
    summary_.bends_like_seed = options.bend != "flat";
    for (const Light& light : input.lights) {
      lights_.push_back(frame_.FromWorld(light));
      solve_lights_.push_back(options.lights == "solve" || (options.lights == "auto" && light.sigma > 0));
    }
    known_lights_ = lights_;
    if (options.use_highlights)
      for (const Contact& contact : MakeContacts(input.scene, input.highlights, options.contacts))
        contacts_.push_back(frame_.FromWorld(contact));
    misfit_.assign(contacts_.size(), 0);
    lobes_.resize(contacts_.size());
    MakePoints();
  }

  RefineResult Run() {
    RefineResult result;
    summary_.num_highlights = static_cast<int>(input_.highlights.size());
    summary_.num_points = static_cast<int>(points_.size());
    size_t steps = 0;
    for (int level = 0; level < options_.levels; ++level) steps += StepsOfIteration(level) * MaxIterations();
    progress_.Begin("refine", steps);
    for (int level = 0; level < options_.levels; ++level) {
      const double voxel = options_.voxel_rel * std::pow(2.0, options_.levels - 1 - level);
      const bool finished = RunLevel(voxel, StepsOfIteration(level));
      if (level + 1 == options_.levels) summary_.converged = finished;
    }
    Finish(result);
    return result;
  }

 private:
  void MakePoints();
  // Four times the surface takes four times as long: the steps of progress are weighed so.
  static size_t StepsOfIteration(int level) { return size_t{1} << (2 * level); }
  size_t MaxIterations() const { return static_cast<size_t>(options_.max_iterations); }
  bool RunLevel(double voxel, size_t progress_steps);
  LevelSet Step(const LevelSet& seed_field, bool undecided, StepSummary& summary);
  void TakeSurface(const LevelSet& stepped, const SdfOptions& sdf);
  double UpdateContacts(const LevelSet& field, IterationSummary& iteration);
  void MeasureLobes(const RayCaster& caster);
  void UpdatePoints(const LevelSet& field);
  std::vector<OrientedPoint> OrientedPoints() const;
  void AddLobes(std::vector<OrientedPoint>& oriented) const;
  void MeasureConfidence();
  void Finish(RefineResult& result);

  const RefineInput& input_;
  const RefineOptions& options_;
  Progress& progress_;
  const UnitFrame frame_;
  TriangleMesh seed_, surface_;
  LevelSet field_;  // of the surface; empty before the first step
  std::vector<Light> lights_, known_lights_;
  std::vector<bool> solve_lights_;
  std::vector<Contact> contacts_;
  std::vector<uint8_t> misfit_;             // a contact: was left out for its size
  std::vector<std::optional<Lobe>> lobes_;  // a contact: its blob on the current surface
  double lobe_width_ = 0;                   // radians, the median
  std::vector<SurfacePoint> points_;
  std::vector<Eigen::Matrix3d> point_covariance_;
  RefineSummary summary_;
};

void Refiner::MakePoints() {
  const Scene& scene = input_.scene;
  if (input_.point_used.empty()) return;
  GLINT_CHECK_EQ(input_.point_used.size(), scene.points.size());
  const std::vector<Eigen::Matrix3d> covariances = PointCovariances(scene, input_.point_used);
  for (size_t i = 0; i < scene.points.size(); ++i) {
    if (!input_.point_used[i]) continue;
    SurfacePoint p;
    p.position = frame_.FromWorld(scene.points[i].position);
    points_.push_back(p);
    point_covariance_.push_back(frame_.scale * frame_.scale * covariances[i]);
  }
}

// Depths at which the rays meet the surface; returns how far the contacts moved (median), on the surface or in the
// bundle, whichever is more.
double Refiner::UpdateContacts(const LevelSet& field, IterationSummary& iteration) {
  const RayCaster caster(surface_);
  // A seed's normals are not to be relied on; those of a surface that has met the contacts once are.
  const bool reliable = !summary_.iterations.empty();
  std::vector<double> surface_motion;
  for (Contact& contact : contacts_) {
    contact.accepted = false;
    contact.reason = HighlightStatus::kInconsistent;
    const auto hit = caster.Intersect(contact.origin, contact.direction);
    if (!hit) {
      contact.reason = HighlightStatus::kOffSurface;
      continue;
    }
    if (contact.prior_depth > 0) surface_motion.push_back(std::abs(hit->t - contact.prior_depth));
    contact.prior_depth = hit->t;
    if (reliable) contact.surface_normal = field.Gradient(hit->position).normalized();
    if (contact.depth == 0) contact.depth = hit->t;
    contact.accepted = Incidence(contact, lights_[contact.light]) < options_.contacts.max_incidence_deg * kRadians;
    iteration.contacts_on_surface += contact.accepted;
  }
  MeasureLobes(caster);
  std::vector<double> before, motion;
  for (const Contact& contact : contacts_) before.push_back(contact.depth);
  iteration.bundle = SolveBundle(points_, 1.0, solve_lights_, options_.bundle, contacts_, lights_, &known_lights_);
  for (size_t i = 0; i < contacts_.size(); ++i)
    if (contacts_[i].accepted) motion.push_back(std::abs(contacts_[i].depth - before[i]));
  return std::max(Median(motion), Median(surface_motion));
}

// A much smaller highlight than the surface would make comes from a sharper place (a rim, a handle) that the seed does
// not have, and its ray meets the surface behind.
void Refiner::MeasureLobes(const RayCaster& caster) {
  std::vector<double> widths;
  for (size_t i = 0; i < contacts_.size(); ++i) {
    lobes_[i].reset();
    if (!contacts_[i].accepted) continue;
    lobes_[i] = LayLobe(contacts_[i], lights_[contacts_[i].light], surface_, caster);
    if (lobes_[i]) widths.push_back(lobes_[i]->Width());
  }
  lobe_width_ = Median(widths);
  for (size_t i = 0; i < contacts_.size(); ++i) {
    if (!lobes_[i]) continue;
    const auto [least, most] = std::minmax({lobes_[i]->turn.col(0).norm(), lobes_[i]->turn.col(1).norm()});
    const double margin = misfit_[i] ? kReturnMargin : 1;
    misfit_[i] = least < margin * kMinWidthShare * lobe_width_ || margin * most > kMaxWidthShare * lobe_width_;
    if (!misfit_[i]) continue;
    contacts_[i].accepted = false;
    contacts_[i].reason = HighlightStatus::kWrongSize;
  }
}

void Refiner::UpdatePoints(const LevelSet& field) {
  for (size_t i = 0; i < points_.size(); ++i) {
    SurfacePoint& p = points_[i];
    const Eigen::Vector3d g = field.Gradient(p.position);
    // Off the band there is no normal; a zero one ties the point to no contact.
    p.normal = g.norm() > 0.5 ? Eigen::Vector3d(g.normalized()) : Eigen::Vector3d::Zero();
    p.surface_position = p.position - field.Value(p.position) * p.normal;
    // Across the surface; off the band, where that is unknown, an average direction's.
    const Eigen::Matrix3d& c = point_covariance_[i];
    const double variance = p.normal.isZero() ? c.trace() / 3 : p.normal.dot(c * p.normal);
    p.sigma = std::max(options_.min_point_sigma_rel, std::sqrt(variance));
  }
}

// The ends of each blob's axes, whose normals its size tells: what the peaks say of the slopes, these say of the
// curvatures.
void Refiner::AddLobes(std::vector<OrientedPoint>& oriented) const {
  const double sigma = std::max(kLeastLobeSigma, kLobeSigmaShare * lobe_width_);
  size_t parent = 0;
  for (size_t i = 0; i < contacts_.size(); ++i) {
    if (!contacts_[i].accepted) continue;
    const OrientedPoint peak = oriented[parent++];
    if (!lobes_[i]) continue;
    const std::array<Eigen::Vector3d, 4> normals = lobes_[i]->NormalsAtEnds(lobe_width_);
    for (int k = 0; k < 4; ++k) {
      OrientedPoint end = peak;
      end.position = lobes_[i]->position[k];
      end.normal = normals[k];
      end.sigma_position = 0;
      end.sigma_normal = std::hypot(peak.sigma_normal, sigma);
      oriented.push_back(end);
    }
  }
}

std::vector<OrientedPoint> Refiner::OrientedPoints() const {
  std::vector<OrientedPoint> oriented;
  for (const Contact& contact : contacts_) {
    if (!contact.accepted) continue;
    OrientedPoint p;
    p.position = contact.SurfacePosition();
    p.bundle_position = contact.Position();
    p.normal = ContactNormal(contact, lights_[contact.light]);
    const double facing = std::abs(contact.direction.dot(p.normal));
    p.sigma_position = std::clamp(kBundleCaution * contact.sigma_depth * facing, kLeastBundleSigma, 0.03);
    p.sigma_normal = contact.sigma_normal;
    p.light = contact.light;
    p.sigma_light = 0.5 * DirectionSigma(lights_[contact.light], contact);
    oriented.push_back(p);
  }
  // A contact explains the surface as far as the next few contacts are.
  constexpr size_t kNear = 6;
  for (OrientedPoint& p : oriented) {
    std::vector<double> distances;
    for (const OrientedPoint& q : oriented) distances.push_back((q.position - p.position).norm());
    const size_t k = std::min(kNear, distances.size() - 1);
    std::nth_element(distances.begin(), distances.begin() + k, distances.end());
    p.reach = std::clamp(distances[k], 0.02, 0.12);
  }
  if (options_.use_lobes) AddLobes(oriented);
  return oriented;
}

// A faired seed bends much as the object does, a raw mesh is rough: the first step of each level
// tells which it is, at the roughness that its voxels resolve.
LevelSet Refiner::Step(const LevelSet& seed_field, bool undecided, StepSummary& summary) {
  const std::vector<OrientedPoint> oriented = OrientedPoints();
  const double area = SurfaceArea(surface_);
  const auto step = [&](bool bend_like_seed, StepSummary& report) {
    return VariationalStep({field_, seed_field, bend_like_seed, area, oriented, points_}, options_.level_set, &report);
  };
  LevelSet stepped = step(summary_.bends_like_seed, summary);
  if (!undecided || !summary_.bends_like_seed || options_.bend != "auto") return stepped;
  StepSummary flat_summary;
  LevelSet flat = step(false, flat_summary);
  if (summary.energy_after <= flat_summary.energy_after) return stepped;
  summary_.bends_like_seed = false;
  summary = flat_summary;
  return flat;
}

// True distances again, from the smooth zero set: from a mesh its facets would show in the normals.
void Refiner::TakeSurface(const LevelSet& stepped, const SdfOptions& sdf) {
  const TriangleMesh extracted = ExtractMesh(stepped);
  surface_ = WithoutCrumbs(extracted);
  field_ = surface_.faces.size() == extracted.faces.size() ? Redistance(stepped, sdf.half_width_voxels)
                                                           : MeshToLevelSet(surface_, stepped.voxel_size(), sdf);
}

bool Refiner::RunLevel(double voxel, size_t progress_steps) {
  SdfOptions sdf;
  sdf.half_width_voxels = std::max(8.0, 2 * options_.half_width_voxels);
  const LevelSet seed_field = MeshToLevelSet(seed_, voxel, sdf);
  // On the coarse levels contacts may still lie a few voxels off the surface.
  sdf.half_width_voxels = options_.half_width_voxels + (voxel > 1.5 * options_.voxel_rel ? 2 : 0);
  if (!field_.empty()) field_ = Resample(field_, voxel, sdf.half_width_voxels);
  for (int k = 0; k < options_.max_iterations; ++k) {
    progress_.ThrowIfCancelled();
    const auto start = std::chrono::steady_clock::now();
    IterationSummary iteration;
    iteration.voxel_rel = voxel;
    if (field_.empty()) field_ = MeshToLevelSet(surface_, voxel, sdf);
    UpdatePoints(field_);
    iteration.contact_motion_voxels = UpdateContacts(field_, iteration) / voxel;
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

void Refiner::MeasureConfidence() {
  const double voxel = std::max(options_.voxel_rel, kConfidenceVoxelRel);
  SdfOptions sdf;
  sdf.half_width_voxels = std::max(8.0, 2 * options_.half_width_voxels);
  const LevelSet seed_field = MeshToLevelSet(seed_, voxel, sdf);
  const LevelSet field = Resample(field_, voxel, options_.half_width_voxels + 1);
  const StepInput input{field, seed_field, summary_.bends_like_seed, SurfaceArea(surface_), OrientedPoints(), points_};
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
  for (const Contact& contact : contacts_) {
    if (contact.accepted)
      result.contacts.push_back(frame_.ToWorld(contact));
    else
      result.highlights[contact.highlight].status = contact.reason;
  }
  for (size_t k = 0; k < lights_.size(); ++k) result.lights.push_back(frame_.ToWorld(lights_[k]));
  summary_.num_contacts = static_cast<int>(result.contacts.size());
  if (!summary_.converged)
    summary_.warnings.push_back(
        fmt::format("the contacts still moved after {} iterations at the finest level", options_.max_iterations));
  result.summary = summary_;
}

}  // namespace

RefineResult Refine(const RefineInput& input, const RefineOptions& options, Progress& progress) {
  GLINT_CHECK(!input.seed.faces.empty());
  return Refiner(input, options, progress).Run();
}

}  // namespace glint
