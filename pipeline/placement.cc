#include "pipeline/placement.h"

#include <fmt/format.h>

#include "metrics/align.h"
#include "pipeline/similarity.h"

namespace glint {
namespace {

constexpr double kOtherSize = 3;  // times as large or small: hardly the same thing in the same unit

std::string DoubtAboutFrames(TriangleMesh mesh, const TriangleMesh& reference, const Eigen::Affine3d& placed) {
  Transform(placed, mesh);
  const double ratio = Diagonal(mesh) / Diagonal(reference);
  if (ratio < kOtherSize && ratio > 1 / kOtherSize && BoundingBox(mesh).intersects(BoundingBox(reference))) return "";
  const double apart = (BoundingBox(mesh).center() - BoundingBox(reference).center()).norm() / Diagonal(reference);
  return fmt::format(
      "the mesh is {:.3g} times as large as the reference, and {:.3g} of its diagonals away from it: are they in one "
      "frame? --align similarity lays it on the reference, --transform FILE where you say",
      ratio, apart);
}

}  // namespace

Placement PlaceOnReference(const TriangleMesh& mesh, const TriangleMesh& reference,
                           const std::filesystem::path& transform, const std::string& align, Progress& progress) {
  Placement placed;
  if (!transform.empty()) placed.reference_from_mesh = ReadSimilarity(transform);
  if (align.empty()) {
    placed.doubt = DoubtAboutFrames(mesh, reference, placed.reference_from_mesh);
    return placed;
  }
  const Alignment found = AlignMeshes(mesh, reference, align == "similarity", placed.reference_from_mesh, progress);
  placed.reference_from_mesh = found.reference_from_mesh;
  placed.aligned =
      fmt::format("laid on the reference: turned by {:.2f} deg, scaled by {:.6g}, nine tenths {:.3g} % off",
                  found.turned_deg, found.scale, 100 * found.mean_rel);
  return placed;
}

}  // namespace glint
