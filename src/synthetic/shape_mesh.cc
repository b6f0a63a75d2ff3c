#include "synthetic/shape_mesh.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <cmath>

#include "core/check.h"
#include "core/parallel.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr int kBlock = 8;  // voxels along an edge of a leaf

Vector3d WorldOf(const ImplicitShape& shape, double voxel, double i, double j, double k) {
  return shape.center() + voxel * Vector3d(i, j, k);
}

// The values of a block that the surface may pass, or the sign of one that it cannot.
struct Block {
  openvdb::Coord origin;
  std::vector<float> values;
  bool inside = false;
};

std::vector<Block> SampleBlocks(const ImplicitShape& shape, double voxel) {
  const int blocks = static_cast<int>(std::ceil(shape.radius() / voxel / kBlock)) + 1, side = 2 * blocks;
  std::vector<Block> sampled(static_cast<size_t>(side) * side * side);
  // Beyond this value at its middle a block is more than two voxels away from the surface.
  const double reach = voxel * (0.5 * kBlock * std::sqrt(3.0) + 2);
  ParallelFor(sampled.size(), 64, [&](size_t index) {
    Block& block = sampled[index];
    const int b = static_cast<int>(index);
    block.origin = openvdb::Coord(kBlock * (b % side - blocks), kBlock * (b / side % side - blocks),
                                  kBlock * (b / side / side - blocks));
    const double half = 0.5 * (kBlock - 1);
    const double middle =
        shape.Value(WorldOf(shape, voxel, block.origin.x() + half, block.origin.y() + half, block.origin.z() + half));
    block.inside = middle < 0;
    if (std::abs(middle) > reach) return;
    for (int i = 0; i < kBlock; ++i)
      for (int j = 0; j < kBlock; ++j)
        for (int k = 0; k < kBlock; ++k) {
          const Vector3d x = WorldOf(shape, voxel, block.origin.x() + i, block.origin.y() + j, block.origin.z() + k);
          // First-order distance: evens out the shape's scaling.
          block.values.push_back(static_cast<float>(shape.Value(x) / std::max(shape.Gradient(x).norm(), 1e-3)));
        }
  });
  return sampled;
}

openvdb::FloatGrid::Ptr SampleGrid(const ImplicitShape& shape, double voxel) {
  openvdb::initialize();
  const float background = static_cast<float>(3 * voxel);
  auto grid = openvdb::FloatGrid::create(background);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  auto accessor = grid->getAccessor();
  for (const Block& block : SampleBlocks(shape, voxel)) {
    if (block.values.empty()) {
      if (block.inside) grid->fill(openvdb::CoordBBox::createCube(block.origin, kBlock), -background, false);
      continue;
    }
    size_t next = 0;
    for (int i = 0; i < kBlock; ++i)
      for (int j = 0; j < kBlock; ++j)
        for (int k = 0; k < kBlock; ++k) accessor.setValue(block.origin.offsetBy(i, j, k), block.values[next++]);
  }
  return grid;
}

void AddTriangle(TriangleMesh& mesh, uint32_t a, uint32_t b, uint32_t c) {
  mesh.faces.emplace_back(static_cast<int>(a), static_cast<int>(b), static_cast<int>(c));
}

}  // namespace

TriangleMesh MeshShape(const ImplicitShape& shape, int resolution) {
  GLINT_CHECK_GE(resolution, 8);
  const double voxel = 2 * shape.radius() / resolution;
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*SampleGrid(shape, voxel), points, triangles, quads, 0.0, 0.0);
  TriangleMesh mesh;
  mesh.vertices.resize(points.size());
  mesh.normals.resize(points.size());
  ParallelFor(points.size(), 1024, [&](size_t i) {
    const auto& p = points[i];  // in voxels: the grid has the unit transform
    mesh.vertices[i] = ProjectToSurface(shape, WorldOf(shape, voxel, p.x(), p.y(), p.z()));
    mesh.normals[i] = shape.Normal(mesh.vertices[i]);
  });
  for (const auto& t : triangles) AddTriangle(mesh, t[0], t[1], t[2]);
  for (const auto& q : quads) {
    // The shorter diagonal.
    const bool first = (mesh.vertices[q[0]] - mesh.vertices[q[2]]).squaredNorm() <=
                       (mesh.vertices[q[1]] - mesh.vertices[q[3]]).squaredNorm();
    AddTriangle(mesh, q[0], q[1], first ? q[2] : q[3]);
    if (first)
      AddTriangle(mesh, q[0], q[2], q[3]);
    else
      AddTriangle(mesh, q[1], q[2], q[3]);
  }
  if (SignedVolume(mesh) < 0)
    for (Eigen::Vector3i& f : mesh.faces) std::swap(f[1], f[2]);
  return mesh;
}

}  // namespace glint
