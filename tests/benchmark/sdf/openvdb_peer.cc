#include <openvdb/tools/MeshToVolume.h>

#include "sdf/level_set_impl.h"
#include "tests/benchmark/sdf/peers.h"

namespace glint::benchmark {

namespace {

// Points in index space and in double, as meshToVolume wants them.
class Adapter {
 public:
  Adapter(const TriangleMesh& mesh, double voxel_size) : mesh_(mesh), scale_(1 / voxel_size) {}
  size_t polygonCount() const { return mesh_.faces.size(); }
  size_t pointCount() const { return mesh_.vertices.size(); }
  size_t vertexCount(size_t) const { return 3; }
  void getIndexSpacePoint(size_t n, size_t v, openvdb::Vec3d& p) const {
    const Eigen::Vector3d& x = mesh_.vertices[mesh_.faces[n][static_cast<int>(v)]];
    p = {x[0] * scale_, x[1] * scale_, x[2] * scale_};
  }

 private:
  const TriangleMesh& mesh_;
  double scale_;
};

}  // namespace

LevelSet OpenVdbLevelSet(const TriangleMesh& mesh, double voxel_size, double half_width_voxels) {
  const Adapter adapter(mesh, voxel_size);
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel_size);
  const float width = static_cast<float>(half_width_voxels);
  return MakeLevelSet(openvdb::tools::meshToVolume<openvdb::FloatGrid>(adapter, *transform, width, width));
}

}  // namespace glint::benchmark
