#include "seed/build_seed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "geometry/closest_point.h"
#include "geometry/components.h"
#include "geometry/self_intersections.h"
#include "sdf/extract_mesh.h"
#include "sdf/mesh_to_level_set.h"
#include "seed/sparse_surface.h"
#include "seed/subdivide.h"

namespace glint {
namespace {

constexpr double kRegionMargin = 0.05;  // of the diagonal
constexpr int kRounds = 3;              // of surface, fairing, and leaving out the points that it disbelieves
constexpr int kMaxStiffenings = 4;
constexpr double kMendVoxels = 0.7;     // edges of the smooth seed: about as fine as it is
constexpr double kMinTrust = 0.1;       // points that keep less of their weight are left out
constexpr int kSubdivisions = 2;         // of the smooth surface: its facets must not show at the finest voxels
constexpr double kFootSigmaRel = 5e-3;  // of the diagonal: how well the hidden foot is known

// Sum over the pieces; the mesh is closed and manifold.
long GenusOf(const TriangleMesh& mesh) {
  const long euler = static_cast<long>(mesh.vertices.size()) - static_cast<long>(mesh.faces.size()) / 2;
  return 1 - euler / 2;
}

// What the smooth surface should pass: the object's points on the sparse surface, and its foot on the ground. Many
// views that agree are hardly wrong; two views agree on any mismatch along their epipolar line.
std::vector<Attachment> Attachments(const Scene& scene, const SparseSurface& surface,
                                    const PointReliability& reliability) {
  const double foot_sigma = kFootSigmaRel * Diagonal(surface.mesh);
  std::vector<Attachment> attachments;
  for (size_t v = 0; v < surface.mesh.vertices.size(); ++v) {
    if (surface.scene_point[v] == kMiddleVertex) continue;
    Attachment a{surface.mesh.vertices[v], foot_sigma, 1, surface.scene_point[v]};
    if (const int point = surface.scene_point[v]; point >= 0) {
      const double views = static_cast<double>(scene.points[point].observations.size());
      a.sigma = reliability.sigma[point];
      a.credit = std::clamp((views - 1) / 2, 0.5, 3.0);
    }
    attachments.push_back(a);
  }
  return attachments;
}

TriangleMesh LargestPiece(const TriangleMesh& mesh) {
  const Components pieces = FindComponents(mesh, BuildEdgeTopology(mesh));
  size_t largest = 0;
  for (size_t k = 1; k < pieces.list.size(); ++k)
    if (pieces.list[k].volume > pieces.list[largest].volume) largest = k;
  TriangleMesh out = mesh;
  out.faces.clear();
  for (size_t f = 0; f < mesh.faces.size(); ++f)
    if (pieces.of_face[f] == largest) out.faces.push_back(mesh.faces[f]);
  return WithoutUnusedVertices(out);
}

// Fairs ever more stiffly until the surface does not pass through itself; if it always does, takes it by its inside.
FairResult FairWithoutFolds(const TriangleMesh& mesh, const std::vector<Attachment>& attachments,
                            const FairContext& context, FairOptions options, SeedSummary& summary) {
  FairResult result;
  for (int attempt = 0; attempt < kMaxStiffenings; ++attempt) {
    result = FairThroughPoints(mesh, attachments, context, options);
    if (SelfIntersections(result.mesh, 1).empty()) return result;
    options.smoothing *= 1.6;
  }
  // Its inside, by winding number, has a surface that does not.
  const double voxel = kMendVoxels * options.edge_rel * Diagonal(result.mesh);
  TriangleMesh mended = LargestPiece(ExtractMesh(MeshToLevelSet(result.mesh, voxel, {.sign = "winding"})));
  if (mended.empty() || !SelfIntersections(mended, 1).empty()) {
    summary.warnings.push_back("the smooth seed passes through itself");
    return result;
  }
  result.mesh = std::move(mended);
  return result;
}

// Takes the points that the smooth surface disbelieves out of the object; true if there were any.
bool DropDoubted(const std::vector<Attachment>& attachments, const FairResult& fair, PointReliability& reliability,
                 ObjectChoice& choice) {
  bool any = false;
  for (size_t i = 0; i < attachments.size(); ++i) {
    const int point = attachments[i].point;
    if (point < 0 || fair.trust[i] > kMinTrust || choice.role[point] != PointRole::kObject) continue;
    reliability.status[point] = PointStatus::kVirtual;
    choice.role[point] = PointRole::kUnused;
    any = true;
  }
  return any;
}

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

}  // namespace

void SeedOptions::Visit(OptionVisitor& v) {
  VisitSection(v, "points", "Which sparse points are believed", points);
  VisitSection(v, "object", "Which part of the scene is the object", object);
  VisitSection(v, "surface", "The visibility-consistent surface of the points", surface);
  VisitSection(v, "smooth", "The smooth surface that refinement starts on", smooth);
}

std::string SeedSummary::BriefReport() const {
  std::string text =
      fmt::format("seed from {} of {} points (object by {}; {} unreliable, {} virtual left out), genus {}",
                  num_object_points, num_points, object_chosen_by, num_unreliable, num_virtual, genus);
  for (const std::string& warning : warnings) text += "; " + warning;
  return text;
}

SeedResult BuildSeed(const Scene& scene, const SeedOptions& options, SeedSummary* summary, Progress& progress,
                     const ImageSource* masks) {
  SeedSummary unused;
  SeedSummary& s = summary ? *summary : unused;
  s = SeedSummary();
  SeedResult out;
  progress.Begin("seed", 4);
  PointReliability reliability = JudgePoints(scene, options.points);
  progress.Advance();
  ObjectChoice choice = ChooseObject(scene, reliability, options.object, options.surface, masks, progress);
  CountPoints(reliability, choice, s);
  out.point_used.assign(scene.points.size(), 0);
  progress.Advance();
  progress.ThrowIfCancelled();
  out.fate = Fates(reliability, choice, out.point_used);
  if (s.num_object_points < 4) {
    s.warnings.push_back(fmt::format("only {} sparse points on the object: no seed", s.num_object_points));
    return out;
  }
  FairContext context;
  for (const View& view : scene.views) context.eyes.push_back(view.Center());
  if (choice.ground) context.ground = choice.ground->plane;
  SparseSurface surface;
  FairResult fair;
  for (int round = 0; round < kRounds; ++round) {
    surface = MakeSparseSurface(scene, reliability, choice, options.surface);
    progress.ThrowIfCancelled();
    if (surface.mesh.empty()) break;
    const std::vector<Attachment> attachments = Attachments(scene, surface, reliability);
    fair = FairWithoutFolds(surface.mesh, attachments, context, options.smooth, s);
    if (round + 1 == kRounds || !DropDoubted(attachments, fair, reliability, choice)) break;
  }
  CountPoints(reliability, choice, s);
  progress.Advance();
  progress.ThrowIfCancelled();
  if (surface.mesh.empty()) {
    s.warnings.push_back("the sparse points enclose no volume: no seed");
    return out;
  }
  out.mesh = surface.mesh;
  out.smooth = SubdivideSmoothly(fair.mesh, kSubdivisions);
  for (int point : surface.scene_point)
    if (point >= 0) out.point_used[point] = 1;
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
