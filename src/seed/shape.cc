#include "seed/shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/components.h"
#include "geometry/mesh_checks.h"
#include "geometry/self_intersections.h"
#include "sdf/extract_mesh.h"
#include "sdf/mesh_to_level_set.h"
#include "seed/remesh.h"
#include "seed/stiffness.h"

namespace glint {
namespace {

constexpr int kRounds = 3;  // of surface, fairing, and leaving out the points that it disbelieves
constexpr int kMaxStiffenings = 4;
constexpr double kStiffer = 1.6;
// Of the stiffness, for a wall: two sheets that are closer to each other than their points pull each other
// through.
constexpr double kSofter = 0.5;
// Edges of the smooth seed: about as fine as it is, and others where two sheets touch on those voxels.
constexpr std::array<double, 3> kMendVoxels = {0.7, 0.5, 1.0};
constexpr double kLeastMended = 0.5;      // of the sparse surface's volume
constexpr double kMinTrust = 0.1;         // points that keep less of their weight are left out
constexpr double kHiddenSigmaRel = 5e-3;  // of the diagonal: how well the foot and the back of a thin wall are known
constexpr double kBackSigmaRel = 0.02;    // the back, where outlines say more: how thick the wall is nobody has seen

// Many views that agree are hardly wrong; two views agree on any mismatch along their epipolar line.
Attachment AttachmentOf(const Scene& scene, const PointReliability& reliability, int point) {
  const double views = static_cast<double>(scene.points[point].observations.size());
  return {scene.points[point].position, reliability.sigma[point], std::clamp((views - 1) / 2, 0.5, 3.0), point};
}

// What the smooth surface should pass: the object's points on the sparse surface, and its foot on the ground.
std::vector<Attachment> Attachments(const Scene& scene, const SparseSurface& surface,
                                    const PointReliability& reliability, const RimEvidence& rim) {
  const double hidden_sigma = kHiddenSigmaRel * Diagonal(surface.mesh);
  std::vector<Attachment> attachments;
  for (size_t v = 0; v < surface.mesh.vertices.size(); ++v) {
    if (surface.scene_point[v] == kMiddleVertex) continue;
    Attachment a{surface.mesh.vertices[v], hidden_sigma, 1, surface.scene_point[v]};
    if (const int point = surface.scene_point[v]; point >= 0) {
      a = AttachmentOf(scene, reliability, point);
    } else if (point == kBackVertex) {
      if (!rim.points.empty()) a.sigma = kBackSigmaRel * Diagonal(surface.mesh);
      a.extra = true;
    } else if (point <= kFirstRimVertex) {
      a.sigma = rim.points[kFirstRimVertex - point].sigma;
      a.extra = true;
    }
    attachments.push_back(a);
  }
  for (const int point : surface.beside) attachments.push_back(AttachmentOf(scene, reliability, point));
  return attachments;
}

// A thin wall may also pass through itself as a whole: it is inside out then.
bool InsideOut(const TriangleMesh& mesh) { return SignedVolume(mesh) <= 0; }

bool PassesThroughItself(const TriangleMesh& mesh) { return InsideOut(mesh) || !SelfIntersections(mesh, 1).empty(); }

bool BoundsASolid(const TriangleMesh& mesh) {
  return CheckMeshSoundness(mesh, {.self_intersections = false, .max_places = 0}).bounds_a_solid() &&
         SelfIntersections(mesh, 1).empty();
}

// The inside of a surface that passes through itself, by winding number: its surface does not, but two sheets of it may
// touch, which other voxels may part. Nothing if they do not, or if little is left of `volume`.
std::optional<TriangleMesh> Mended(const TriangleMesh& crossing, double edge, double volume) {
  for (const double edges : kMendVoxels) {
    TriangleMesh mended = LargestPiece(ExtractMesh(MeshToLevelSet(crossing, edges * edge, {.sign = "winding"})));
    if (SignedVolume(mended) >= kLeastMended * volume && BoundsASolid(mended)) return mended;
  }
  return std::nullopt;
}

// Fairs as asked for, a wall more softly, and ever more stiffly, until the surface does not pass through itself; if it
// always does, takes the first that is not inside out by its inside.
FairResult FairWithoutFolds(const SparseSurface& surface, const std::vector<Attachment>& attachments,
                            const FairContext& context, const FairOptions& options, Fairing& how) {
  const TriangleMesh& mesh = surface.mesh;
  std::vector<double> factors = {1};
  if (surface.is_wall) factors.push_back(kSofter);
  for (int k = 1; k < kMaxStiffenings; ++k) factors.push_back(std::pow(kStiffer, k));
  std::optional<FairResult> softest;
  how = Fairing::kSmooth;
  for (const double factor : factors) {
    FairOptions attempt = options;
    attempt.smoothing *= factor;
    FairResult result = FairThroughPoints(mesh, attachments, context, attempt);
    if (!PassesThroughItself(result.mesh)) return result;
    if (!softest || (InsideOut(softest->mesh) && !InsideOut(result.mesh))) softest = std::move(result);
  }
  how = Fairing::kMended;
  if (!InsideOut(softest->mesh)) {
    auto mended = Mended(softest->mesh, options.edge_rel * Diagonal(softest->mesh), SignedVolume(mesh));
    if (mended) return {*std::move(mended), std::move(softest->trust)};
  }
  // Nothing smooth comes of these points: their facets, which they do not contradict.
  TriangleMesh facets = RemeshEvenly(mesh, options.edge_rel * Diagonal(mesh));
  if (!BoundsASolid(facets)) facets = mesh;
  if (BoundsASolid(facets))
    softest->mesh = std::move(facets);
  else
    how = Fairing::kFolded;
  return *std::move(softest);
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

}  // namespace

TriangleMesh PieceOf(const TriangleMesh& mesh, const Components& pieces, size_t k) {
  TriangleMesh out = mesh;
  out.faces.clear();
  for (size_t f = 0; f < mesh.faces.size(); ++f)
    if (pieces.of_face[f] == k) out.faces.push_back(mesh.faces[f]);
  return WithoutUnusedVertices(out);
}

TriangleMesh LargestPiece(const TriangleMesh& mesh) {
  const Components pieces = FindComponents(mesh, BuildEdgeTopology(mesh));
  size_t largest = 0;
  for (size_t k = 1; k < pieces.list.size(); ++k)
    if (pieces.list[k].volume > pieces.list[largest].volume) largest = k;
  return PieceOf(mesh, pieces, largest);
}

long GenusOf(const TriangleMesh& mesh) {
  const long euler = static_cast<long>(mesh.vertices.size()) - static_cast<long>(mesh.faces.size()) / 2;
  return 1 - euler / 2;
}

Shape MakeShape(const Scene& scene, PointReliability& reliability, ObjectChoice& choice, const RimEvidence& rim,
                const CutOptions& cut, const FairOptions& fair_options, Progress& progress) {
  FairContext context;
  for (const View& view : scene.views) context.eyes.push_back(view.Center());
  if (choice.ground) context.ground = choice.ground->plane;
  Shape shape;
  for (int round = 0; round < kRounds; ++round) {
    shape.sparse = MakeSparseSurface(scene, reliability, choice, cut, rim);
    progress.ThrowIfCancelled();
    if (shape.sparse.mesh.empty()) return {};
    context.even_walls = !shape.sparse.is_wall;
    const std::vector<Attachment> attachments = Attachments(scene, shape.sparse, reliability, rim);
    FairResult fair = FairWithoutFolds(shape.sparse, attachments, context, fair_options, shape.fairing);
    shape.smooth = std::move(fair.mesh);
    if (round + 1 < kRounds && DropDoubted(attachments, fair, reliability, choice)) continue;
    FairOptions stiffer = fair_options;
    stiffer.smoothing = SmoothingByHoldingOut(shape.smooth, attachments, context, fair_options);
    if (stiffer.smoothing > fair_options.smoothing) {
      TriangleMesh stiff = FairThroughPoints(shape.sparse.mesh, attachments, context, stiffer).mesh;
      if (PassesThroughItself(stiff)) break;
      shape.smooth = std::move(stiff);
      shape.fairing = Fairing::kSmooth;
    }
    break;
  }
  return shape;
}

}  // namespace glint
