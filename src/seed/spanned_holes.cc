#include "seed/spanned_holes.h"

#include <algorithm>
#include <array>

#include "geometry/components.h"
#include "geometry/edge_topology.h"
#include "sdf/csg.h"
#include "sdf/field_mesh.h"
#include "seed/shape.h"

namespace glint {
namespace {

// Views that look through a hole before it is one: so many, and one of so many. Then what two see through is none of
// the object's, as far as it hangs together with it: whoever looks in aslant sees more of it.
constexpr size_t kMinViews = 3, kShareOfViews = 10, kViewsOnce = 2;
constexpr double kCoarse = 2.5;                         // voxels: no hole in an outline is as narrow
constexpr double kMarginVoxels = 4;                     // beyond the mesh
constexpr double kLeastVolume = 1e-3;                   // of the mesh's: a tunnel
constexpr std::array<double, 3> kClosings = {0, 1, 2};  // voxels: what is ragged in a tunnel's walls
constexpr double kNarrow = 4;                           // voxels: radius that a tunnel has at least

// What so many views see through in and around the mesh, piece by piece, the largest first.
std::vector<TriangleMesh> SeenThrough(const Silhouettes& silhouettes, const TriangleMesh& mesh, double voxel,
                                      size_t views) {
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  if (!silhouettes.SeenThroughBy(box.center(), views)) return {};
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(kMarginVoxels * voxel);
  const Eigen::AlignedBox3d around(box.min() - margin / 2, box.max() + margin / 2);
  const Eigen::Vector3i size = ((box.sizes() + 2 * margin) / voxel).array().ceil().cast<int>() + 1;
  const TriangleMesh through = MeshOfFunction(box.min() - margin, voxel, size, [&](const Eigen::Vector3d& at) {
    return around.contains(at) ? -silhouettes.SeenThroughBy(at, views).value_or(-voxel) : voxel;
  });
  const Components pieces = FindComponents(through, BuildEdgeTopology(through));
  std::vector<TriangleMesh> out;
  for (size_t k = 0; k < pieces.list.size(); ++k)
    if (pieces.list[k].volume >= kLeastVolume * SignedVolume(mesh)) out.push_back(PieceOf(through, pieces, k));
  std::stable_sort(out.begin(), out.end(),
                   [](const TriangleMesh& a, const TriangleMesh& b) { return SignedVolume(a) > SignedVolume(b); });
  return out;
}

// With a tunnel where the piece is, as smooth as it must be to be one; as it is if it is none.
TriangleMesh Pierced(const TriangleMesh& mesh, const TriangleMesh& piece, double voxel, double rounding) {
  const TriangleMesh pierced = Difference(mesh, piece, voxel, rounding);
  const auto closed = [&](double voxels) { return LargestPiece(Closing(pierced, voxel, voxels * voxel)); };
  if (GenusOf(closed(kNarrow)) != GenusOf(mesh) + 1) return mesh;
  for (const double voxels : kClosings) {
    TriangleMesh out = voxels > 0 ? closed(voxels) : LargestPiece(pierced);
    if (GenusOf(out) == GenusOf(mesh) + 1) return out;
  }
  return mesh;
}

}  // namespace

TriangleMesh WithSpannedHoles(const Silhouettes& silhouettes, const TriangleMesh& mesh, double voxel, double rounding) {
  const size_t views = std::max(kMinViews, silhouettes.num_views() / kShareOfViews);
  TriangleMesh out = mesh;
  for (const TriangleMesh& piece : SeenThrough(silhouettes, mesh, kCoarse * voxel, views))
    out = Pierced(out, piece, voxel, rounding);
  if (GenusOf(out) == GenusOf(mesh)) return out;
  TriangleMesh wide = mesh;
  for (const TriangleMesh& piece : SeenThrough(silhouettes, mesh, kCoarse * voxel, kViewsOnce))
    wide = Pierced(wide, piece, voxel, rounding);
  return GenusOf(wide) == GenusOf(out) ? wide : out;
}

}  // namespace glint
