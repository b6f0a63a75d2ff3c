#include "seed/build_seed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "geometry/closest_point.h"
#include "geometry/self_intersections.h"
#include "highlights/sight_colors.h"
#include "sdf/csg.h"
#include "seed/changed_parts.h"
#include "seed/foot.h"
#include "seed/outline_rim.h"
#include "seed/rim_points.h"
#include "seed/shape.h"
#include "seed/spanned_holes.h"
#include "seed/subdivide.h"
#include "stereo/hollows.h"

namespace glint {
namespace {

constexpr double kRegionMargin = 0.05;  // of the diagonal
constexpr int kOutlinePasses = 2;       // found outlines are better where the shape already is
// Of what does not fit the outlines without them, the most that may still not fit with them: outlines from photographs
// are a pixel or so off everywhere, which points are not.
constexpr double kGoodWithout = 0.75;  // share that fits: what points alone explain so well they know better
constexpr double kWorthwhile = 0.85;
constexpr size_t kColorViews = 48;
constexpr size_t kColorMemory = size_t{1} << 29;
constexpr double kVoxelRel = 0.004;     // of the diagonal: as fine as the smooth surface once divided
constexpr double kRoundingRel = 0.012;  // of the diagonal: of a hollow's edge, about the thinnest wall
constexpr double kLeastHollow = 1e-3;   // of the volume: less is for the refinement
constexpr double kLeastTaken = 0.25;    // of the hollows' volume: less, and nothing was opened
constexpr double kFineRel = 0.003;      // of the diagonal
constexpr double kStayRel = 0.01;       // of the diagonal: what is narrower in a hollow's lining is noise
constexpr int kSubdivisions = 2;        // of the smooth surface: its facets must not show at the finest voxels

double MedianDistance(const TriangleMesh& mesh, const Scene& scene, const std::vector<uint8_t>& used) {
  const ClosestPointQuery query(mesh);
  std::vector<double> distances;
  for (size_t i = 0; i < used.size(); ++i)
    if (used[i]) distances.push_back(std::sqrt(query.Find(scene.points[i].position)->squared_distance));
  if (distances.empty()) return 0;
  std::nth_element(distances.begin(), distances.begin() + distances.size() / 2, distances.end());
  return distances[distances.size() / 2];
}

std::vector<PointFate> Fates(const PointReliability& reliability, const ObjectChoice& choice,
                             const std::vector<uint8_t>& used) {
  std::vector<PointFate> fate;
  for (size_t i = 0; i < used.size(); ++i) {
    if (reliability.status[i] != PointStatus::kReliable)
      fate.push_back(reliability.status[i] == PointStatus::kVirtual ? PointFate::kVirtual : PointFate::kUnreliable);
    else if (choice.role[i] == PointRole::kObject)
      fate.push_back(used[i] ? PointFate::kUsed : PointFate::kObject);
    else
      fate.push_back(choice.role[i] == PointRole::kGround ? PointFate::kGround : PointFate::kContext);
  }
  return fate;
}

void CountPoints(const PointReliability& reliability, const ObjectChoice& choice, SeedSummary& summary) {
  summary.num_points = reliability.status.size();
  summary.num_virtual = reliability.Count(PointStatus::kVirtual);
  summary.num_unreliable = summary.num_points - summary.num_virtual - reliability.Count(PointStatus::kReliable);
  summary.num_object_points = std::count(choice.role.begin(), choice.role.end(), PointRole::kObject);
  summary.ground_found = choice.ground.has_value();
  summary.object_chosen_by = choice.chosen_by;
}

// 1 for the object's points, -1 for what is known to be another's, 0 for the rest.
std::vector<int8_t> Sides(const ObjectChoice& choice) {
  std::vector<int8_t> side;
  for (const PointRole role : choice.role)
    side.push_back(role == PointRole::kObject ? 1 : role == PointRole::kUnused ? 0 : -1);
  return side;
}

// What has been made of the points so far.
struct Made {
  Shape shape;
  PointReliability reliability;
  ObjectChoice choice;
};

bool Folded(const Shape& shape) { return shape.fairing == Fairing::kFolded; }

// Where no smooth solid comes of the points: slivers of a thin wall, which needs a back.
void MakeOfAWall(const Scene& scene, const Made& points, const SeedOptions& options, Made& made, Progress& progress) {
  Made wall = points;
  wall.shape =
      MakeShape(scene, wall.reliability, wall.choice, {.of_a_wall = true}, options.surface, options.smooth, progress);
  if (wall.shape.sparse.is_wall && wall.shape.fairing < made.shape.fairing) made = std::move(wall);
}

// Outlines around the shape that stands so far, and the shape of points and outlines, which takes its place if it fits
// them better. False if there is nothing more to gain.
bool FollowOutlines(const Scene& scene, const Made& points_alone, const SeedOptions& options, const ImageSource& images,
                    Made& made, SeedSummary& s, Silhouettes& silhouettes, Progress& progress) {
  const ObjectChoice& choice = made.choice;
  const auto ground = choice.ground ? std::optional(choice.ground->plane) : std::nullopt;
  SilhouetteSummary found;
  Silhouettes next =
      FindSilhouettes(scene, images, {made.shape.smooth, Sides(choice), ground}, options.outlines, &found, progress);
  const bool first = s.outlines.source.empty();
  if (first || !next.outline().empty()) s.outlines = found;
  if (next.outline().empty()) return false;
  silhouettes = std::move(next);
  const std::vector<OutlineSample>& outline = silhouettes.outline();
  s.outline_fit_before = OutlineFit(scene, outline, points_alone.shape.smooth);
  s.outline_fit = OutlineFit(scene, outline, made.shape.smooth);
  if (!s.outlines_used && found.source == "photographs" && s.outline_fit_before > kGoodWithout) return false;
  std::vector<Eigen::Vector3d> points;
  for (size_t i = 0; i < choice.role.size(); ++i)
    if (choice.role[i] == PointRole::kObject) points.push_back(scene.points[i].position);
  RimEvidence rim = RimFromOutline(scene, outline, points,
                                   {.diagonal = Diagonal(made.shape.smooth),
                                    .carve = found.source == "masks",
                                    .few_sides = silhouettes.from_few_sides()});
  AddHullPoints(silhouettes.hull(), made.shape.smooth, points, ground, rim);
  rim.of_a_wall = points_alone.shape.sparse.is_wall;
  Made with{{}, points_alone.reliability, points_alone.choice};
  with.shape = MakeShape(scene, with.reliability, with.choice, rim, options.surface, options.smooth, progress);
  if (with.shape.sparse.mesh.empty() || (Folded(with.shape) && !Folded(made.shape))) return false;
  const double fit = OutlineFit(scene, outline, with.shape.smooth);
  const double most_left = s.outlines_used ? 1 : kWorthwhile;
  if (1 - fit >= most_left * (1 - s.outline_fit)) return false;
  s.outline_fit = fit;
  s.outlines_used = true;
  s.num_rim_points = rim.points.size();
  made = std::move(with);
  return found.source == "photographs";  // masks do not change
}

// Finer, unless that swings through itself where the surface is thin and rough.
TriangleMesh Subdivided(const Shape& shape) {
  TriangleMesh fine = SubdivideSmoothly(shape.smooth, kSubdivisions);
  return Folded(shape) || SelfIntersections(fine, 1).empty() ? fine : shape.smooth;
}

// What comes of a finer change to the surface, unless it tears tunnels: then what was found fits together nowhere.
TriangleMesh UnlessTorn(const TriangleMesh& before, const TriangleMesh& after) {
  return after.empty() || GenusOf(after) > GenusOf(before) ? before : after;
}

// Holes that it spans, through which photographs look.
TriangleMesh WithHoles(const Scene& scene, const Silhouettes& silhouettes, const TriangleMesh& smooth, SeedSummary& s) {
  const double diagonal = Diagonal(smooth);
  const TriangleMesh with = WithSpannedHoles(silhouettes, smooth, kVoxelRel * diagonal, kRoundingRel * diagonal);
  s.num_holes = GenusOf(with) - GenusOf(smooth);
  return s.num_holes == 0 ? smooth : SmoothChangedParts(scene, silhouettes.outline(), smooth, with, 0);
}

// Hollows that it spans, which nothing but their colours shows, are taken out of it.
TriangleMesh WithoutHollows(const Scene& scene, const SparseSurface& sparse, const TriangleMesh& smooth,
                            const std::vector<OutlineSample>& outline, const ImageSource& images, SeedSummary& s,
                            Progress& progress) {
  std::vector<Eigen::Vector3d> known;
  for (const int point : sparse.scene_point)
    if (point >= 0) known.push_back(scene.points[point].position);
  const SightColors colors(images, kColorViews, kColorMemory, progress);
  const TriangleMesh hollows = FindHollows(scene, colors, smooth, known, &s.hollows, progress);
  const double volume = hollows.empty() ? 0 : std::abs(SignedVolume(hollows));
  if (volume <= kLeastHollow * std::abs(SignedVolume(smooth))) return smooth;
  TriangleMesh opened = UnlessTorn(
      smooth, LargestPiece(Difference(smooth, hollows, kVoxelRel * Diagonal(smooth), kRoundingRel * Diagonal(smooth))));
  const double taken = SignedVolume(smooth) - SignedVolume(opened);
  s.hollows_opened = taken > kLeastTaken * volume;
  return s.hollows_opened ? SmoothChangedParts(scene, outline, smooth, opened, kStayRel * Diagonal(smooth)) : smooth;
}

// Where a surface is not the faired one.
void MarkFine(const TriangleMesh& faired, TriangleMesh& mesh) {
  const ClosestPointQuery query(faired);
  const double moved = kFineRel * Diagonal(mesh);
  std::vector<float> fine(mesh.vertices.size());
  ParallelFor(fine.size(), 256, [&](size_t v) { fine[v] = query.Find(mesh.vertices[v], moved) ? 0.0F : 1.0F; });
  mesh.scalars.emplace_back(kFineScalar, std::move(fine));
}

}  // namespace

void SeedOptions::Visit(OptionVisitor& v) {
  VisitSection(v, "points", "Which sparse points are believed", points);
  VisitSection(v, "object", "Which part of the scene is the object", object);
  VisitSection(v, "surface", "The visibility-consistent surface of the points", surface);
  VisitSection(v, "outlines", "The object's outlines, where points are missing", outlines);
  VisitSection(v, "smooth", "The smooth surface that refinement starts on", smooth);
  v.Field({.name = "open_hollows",
           .help = "take hollows (a mouth, a bowl) out of the smooth surface, by the photographs' colours"},
          open_hollows);
}

std::string SeedSummary::BriefReport() const {
  std::string text =
      fmt::format("seed from {} of {} points (object by {}; {} unreliable, {} virtual left out), genus {}",
                  num_object_points, num_points, object_chosen_by, num_unreliable, num_virtual, genus);
  if (!outlines.source.empty()) text += "; " + outlines.BriefReport();
  if (outlines.num_trusted_samples > 0)
    text += fmt::format(
        ", {:.0f} % fit the surface of the points alone{}", 100 * outline_fit_before,
        outlines_used ? fmt::format(", {:.0f} % the seed, with {} points on the rim", 100 * outline_fit, num_rim_points)
                      : ", which is kept");
  if (num_holes > 0) text += fmt::format("; {} hole(s) opened that the photographs look through", num_holes);
  if (hollows_opened)
    text += fmt::format("; {} hollow(s) opened by the colours of what is in them", hollows.num_hollows);
  for (const std::string& warning : warnings) text += "; " + warning;
  return text;
}

SeedResult BuildSeed(const Scene& scene, const SeedOptions& options, SeedSummary* summary, Progress& progress,
                     const ImageSource* images) {
  SeedSummary unused;
  SeedSummary& s = summary ? *summary : unused;
  s = SeedSummary();
  SeedResult out;
  progress.Begin("seed", 4);
  PointReliability reliability = JudgePoints(scene, options.points);
  progress.Advance();
  ObjectChoice choice = ChooseObject(scene, reliability, options.object, options.surface, images, progress);
  CountPoints(reliability, choice, s);
  out.point_used.assign(scene.points.size(), 0);
  progress.Advance();
  progress.ThrowIfCancelled();
  out.fate = Fates(reliability, choice, out.point_used);
  if (s.num_object_points < 4) {
    s.warnings.push_back(fmt::format("only {} sparse points on the object: no seed", s.num_object_points));
    return out;
  }
  Made made{{}, reliability, choice};
  Made alone = made;  // before points are taken out of it
  made.shape = MakeShape(scene, made.reliability, made.choice, {}, options.surface, options.smooth, progress);
  if (made.shape.fairing != Fairing::kSmooth && !made.shape.sparse.is_wall)
    MakeOfAWall(scene, alone, options, made, progress);
  alone.shape = made.shape;
  Silhouettes silhouettes;
  for (int pass = 0; pass < kOutlinePasses && images && !made.shape.sparse.mesh.empty(); ++pass)
    if (!FollowOutlines(scene, alone, options, *images, made, s, silhouettes, progress)) break;
  out.outline = silhouettes.rays();
  const Shape& shape = made.shape;
  reliability = std::move(made.reliability);
  choice = std::move(made.choice);
  if (Folded(shape)) s.warnings.push_back("the smooth seed passes through itself");
  CountPoints(reliability, choice, s);
  progress.Advance();
  progress.ThrowIfCancelled();
  if (shape.sparse.mesh.empty()) {
    s.warnings.push_back("the sparse points enclose no volume: no seed");
    return out;
  }
  out.mesh = shape.sparse.mesh;
  const TriangleMesh faired = Subdivided(shape);
  out.smooth = s.outlines_used ? WithRim(scene, silhouettes, faired, kVoxelRel * Diagonal(faired)) : faired;
  out.smooth = WithHoles(scene, silhouettes, out.smooth, s);
  if (images && options.open_hollows)
    out.smooth = WithoutHollows(scene, shape.sparse, out.smooth, silhouettes.outline(), *images, s, progress);
  if (out.smooth.vertices.size() != faired.vertices.size()) MarkFine(faired, out.smooth);
  if (choice.ground) MarkFoot(*choice.ground, out.smooth);
  for (int point : shape.sparse.scene_point)
    if (point >= 0) out.point_used[point] = 1;
  for (int point : shape.sparse.beside) out.point_used[point] = 1;
  out.fate = Fates(reliability, choice, out.point_used);
  out.region = BoundingBox(out.mesh).merged(BoundingBox(out.smooth));
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(kRegionMargin * Diagonal(out.smooth));
  out.region = Eigen::AlignedBox3d(out.region.min() - margin, out.region.max() + margin);
  s.genus = GenusOf(out.smooth);
  s.smooth_residual_rel = MedianDistance(out.smooth, scene, out.point_used) / Diagonal(out.smooth);
  progress.Advance();
  return out;
}

}  // namespace glint
