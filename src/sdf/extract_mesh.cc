#include "sdf/extract_mesh.h"

#include <openvdb/tools/VolumeToMesh.h>

#include <cmath>

#include "core/parallel.h"
#include "sdf/field_sampler.h"
#include "sdf/level_set_impl.h"
#include "sdf/triangulate_quads.h"

namespace glint {

namespace {

using openvdb::Vec3d;
// Newton steps onto the iso-surface along the gradient; stays within a voxel of where it began.
Vec3d Project(internal::FieldSampler& field, const Vec3d& start, double iso) {
  Vec3d x = start, best = start;
  internal::FieldSample sample = field(x);
  double best_residual = std::abs(sample.value - iso);
  for (int step = 0; step < 5 && best_residual > 0; ++step) {
    const double squared = sample.gradient.lengthSqr();
    if (!(squared > 0)) break;
    x -= sample.gradient * ((sample.value - iso) / squared);
    if ((x - start).lengthSqr() > 1) break;
    sample = field(x);
    const double residual = std::abs(sample.value - iso);
    if (residual < best_residual) best = x;
    if (residual > 0.1 * best_residual) break;  // no longer converging
    best_residual = residual;
  }
  return best;
}

}  // namespace

TriangleMesh ExtractMesh(const LevelSet& level_set, double iso_world) {
  TriangleMesh mesh;
  if (level_set.empty()) return mesh;
  const openvdb::FloatGrid& grid = *level_set.impl().grid;
  RequireInBand(level_set, iso_world);
  // Index space about the band's centre: OpenVDB hands points back in single precision.
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  const openvdb::Coord center(box.min()[0] + (box.max()[0] - box.min()[0]) / 2,
                              box.min()[1] + (box.max()[1] - box.min()[1]) / 2,
                              box.min()[2] + (box.max()[2] - box.min()[2]) / 2);
  const openvdb::FloatGrid::ConstPtr centered = grid.copyReplacingTransform(openvdb::math::Transform::Ptr(
      new openvdb::math::Transform(openvdb::math::MapBase::Ptr(new openvdb::math::TranslationMap(-center.asVec3d())))));
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*centered, points, triangles, quads, iso_world, 0.0, true);

  std::vector<Vec3d> in_index(points.size());
  mesh.vertices.resize(points.size());
  mesh.normals.resize(points.size());
  ParallelChunks(points.size(), 4096, [&](size_t begin, size_t end) {
    internal::FieldSampler field(grid.tree());
    for (size_t v = begin; v < end; ++v) {
      in_index[v] = Project(field, Vec3d(points[v]) + center.asVec3d(), iso_world);
      mesh.vertices[v] = FromVdb(grid.indexToWorld(in_index[v]));
      const Vec3d gradient = grid.transform().baseMap()->applyIJT(field(in_index[v]).gradient);
      mesh.normals[v] = FromVdb(gradient).normalized();
    }
  });
  mesh.faces = internal::Triangulate(in_index, triangles, quads);
  return mesh;
}

}  // namespace glint
