#include "sdf/render.h"

#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "sdf/field_sampler.h"
#include "sdf/level_set_impl.h"

namespace glint {

namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using Tree = openvdb::FloatTree;

// One ray in index space, its direction one voxel long.
class RayMarcher {
 public:
  RayMarcher(const openvdb::FloatGrid& grid, double iso)
      : accessor_(grid.tree()), field_(grid.tree()), iso_(iso), voxel_(grid.voxelSize()[0]) {}

  // The first crossing in [t_min, t_max].
  std::optional<double> FirstCrossing(const Vec3d& origin, const Vec3d& direction, double t_min, double t_max) {
    double t = t_min, previous_t = t_min;
    std::optional<bool> was_inside;
    while (t <= t_max) {
      const Vec3d x = origin + direction * t;
      const Coord ijk = Coord::floor(x);
      const double value = openvdb::tools::BoxSampler::sample(accessor_, x) - iso_;
      const bool inside = value < 0;
      double step = std::max(0.05, 0.8 * std::abs(value) / voxel_);
      if (const int dim = EmptyCube(ijk); dim > 0) step = std::max(step, ExitOfCube(x, direction, ijk, dim) + 0.01);
      if (was_inside && *was_inside != inside) return Refine(origin, direction, previous_t, t, *was_inside);
      was_inside = inside;
      previous_t = t;
      t += step;
    }
    return std::nullopt;
  }

  Vec3d Gradient(const Vec3d& x) { return field_(x).gradient; }

 private:
  // The edge length of the cube about ijk without a leaf in it, if one unit beyond it there is none either: so that
  // trilinear samples in it see no leaf. 0 next to leaves.
  int EmptyCube(const Coord& ijk) {
    if (accessor_.probeConstLeaf(ijk) != nullptr) return 0;
    for (int corner = 1; corner < 8; ++corner)
      if (accessor_.probeConstLeaf(ijk.offsetBy(corner >> 2, corner >> 1 & 1, corner & 1)) != nullptr) return 0;
    using Node2 = Tree::RootNodeType::ChildNodeType;
    using Node1 = Node2::ChildNodeType;
    if (accessor_.probeConstNode<Node1>(ijk) != nullptr) return 8;
    return accessor_.probeConstNode<Node2>(ijk) != nullptr ? 128 : 4096;
  }

  static double ExitOfCube(const Vec3d& x, const Vec3d& direction, const Coord& ijk, int dim) {
    double exit = 1e300;
    for (int k = 0; k < 3; ++k) {
      const double low = ijk[k] & ~(dim - 1);
      if (direction[k] > 0) exit = std::min(exit, (low + dim - 1 - x[k]) / direction[k]);  // where samples leave it
      if (direction[k] < 0) exit = std::min(exit, (low - x[k]) / direction[k]);
    }
    return std::max(exit, 0.0);
  }

  double Refine(const Vec3d& origin, const Vec3d& direction, double low, double high, bool low_inside) {
    for (int i = 0; i < 24; ++i) {
      const double middle = (low + high) / 2;
      const bool inside = field_(origin + direction * middle).value < iso_;
      (inside == low_inside ? low : high) = middle;
    }
    return (low + high) / 2;
  }

  openvdb::tree::ValueAccessor<const Tree, false> accessor_;
  internal::FieldSampler field_;
  double iso_, voxel_;
};

// Where the ray is within the box; empty if low > high.
std::pair<double, double> ClipToBox(const Vec3d& origin, const Vec3d& direction, const openvdb::CoordBBox& box) {
  double low = 0, high = 1e300;
  for (int k = 0; k < 3; ++k) {
    const double a = (box.min()[k] - 1 - origin[k]) / direction[k], b = (box.max()[k] + 1 - origin[k]) / direction[k];
    if (std::isnan(a) || std::isnan(b)) continue;
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  }
  return {low, high};
}

}  // namespace

std::vector<uint8_t> RenderLevelSet(const LevelSet& level_set, const PictureView& view, double iso_world,
                                    const Look& look) {
  Eigen::Vector3d background = LinearFromSrgb(look.background);
  if (level_set.empty()) return RenderPixels(view, look, [&](double, double) { return background; });
  const openvdb::FloatGrid& grid = *level_set.impl().grid;
  RequireInBand(level_set, iso_world);
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  const openvdb::math::MapBase& map = *grid.transform().baseMap();
  const Vec3d origin = grid.worldToIndex(ToVdb(view.CenterInWorld()));
  return RenderPixels(view, look, [&](double x_px, double y_px) {
    const Eigen::Vector3d direction = view.DirectionInWorld(x_px, y_px);
    Vec3d in_index = map.applyInverseJacobian(ToVdb(direction));
    in_index.normalize();
    const auto [low, high] = ClipToBox(origin, in_index, box);
    if (low > high) return background;
    RayMarcher marcher(grid, iso_world);
    const std::optional<double> t = marcher.FirstCrossing(origin, in_index, low, high);
    if (!t) return background;
    const Eigen::Vector3d normal = FromVdb(map.applyIJT(marcher.Gradient(origin + in_index * *t))).normalized();
    return Shade(view, look, direction, {normal, look.color});
  });
}

}  // namespace glint
