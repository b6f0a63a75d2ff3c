// Level sets: from meshes, files and dense arrays, and back.
#include <fmt/format.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <pybind11/stl.h>

#include <cmath>

#include "arrays.h"
#include "background.h"
#include "bindings.h"
#include "core/error.h"
#include "core/parallel.h"
#include "io/vdb_io.h"
#include "sdf/extract_mesh.h"
#include "sdf/level_set_impl.h"
#include "sdf/mesh_to_level_set.h"

namespace glint::python {
namespace {

// Values of NumPy's order: the last index runs fastest.
using Dense = openvdb::tools::Dense<float, openvdb::tools::LayoutZYX>;

py::tuple ToDense(const LevelSet& level_set) {
  if (level_set.empty()) throw InputError("", "level set", "is empty");
  const openvdb::FloatGrid& grid = *level_set.impl().grid;
  // One voxel more to every side, so that the array's rim is off the band.
  openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  box.expand(1);
  const openvdb::Coord size = box.dim();
  Array<float> values({size[0], size[1], size[2]});
  Dense dense(box, values.mutable_data());
  Array<double> world_from_index({4, 4});
  const openvdb::Mat4d by_rows = grid.transform().baseMap()->getAffineMap()->getMat4();
  const openvdb::Vec3d origin = grid.indexToWorld(box.min());
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) world_from_index.mutable_at(r, c) = c == 3 && r < 3 ? origin[r] : by_rows(c, r);
  InBackground(py::none(), [&](Progress&) { openvdb::tools::copyToDense(grid, dense); });
  return py::make_tuple(values, world_from_index);
}

// Everything on the rim of the array must be outside: else the surface is cut off there.
void RequireClosedIn(const Dense& dense) {
  const openvdb::CoordBBox& box = dense.bbox();
  for (auto x = box.begin(); x; ++x) {
    const openvdb::Coord at = *x;
    const float value = dense.getValue(at);
    if (!std::isfinite(value))
      throw InputError("", "values",
                       fmt::format("expected finite distances, found {} at ({}, {}, {})", value, at[0], at[1], at[2]));
    bool rim = false;
    for (int k = 0; k < 3; ++k) rim = rim || at[k] == box.min()[k] || at[k] == box.max()[k];
    if (rim && value <= 0)
      throw InputError("", "values",
                       fmt::format("expected the surface inside the array, but ({}, {}, {}) on its rim is not outside",
                                   at[0], at[1], at[2]));
  }
}

LevelSet FromDense(const Array<float>& values, const Eigen::Vector3d& origin, double voxel_size,
                   double half_width_voxels) {
  const openvdb::Coord size(static_cast<int>(values.shape(0)), static_cast<int>(values.shape(1)),
                            static_cast<int>(values.shape(2)));
  const Dense dense(openvdb::CoordBBox({0, 0, 0}, size.offsetBy(-1)), const_cast<float*>(values.data()));
  const py::gil_scoped_release release;
  RequireClosedIn(dense);
  const auto background = static_cast<float>(half_width_voxels * voxel_size);
  auto grid = openvdb::FloatGrid::create(background);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel_size));
  grid->transform().postTranslate(ToVdb(origin));
  openvdb::tools::copyFromDense(dense, *grid, 0.0F);
  for (auto value = grid->beginValueOn(); value; ++value) {
    if (std::abs(*value) < background) continue;
    value.setValue(std::copysign(background, *value));
    value.setActiveState(false);
  }
  openvdb::tools::signedFloodFill(grid->tree());
  openvdb::tools::pruneLevelSet(grid->tree());
  if (grid->activeVoxelCount() == 0) throw InputError("", "values", "no value lies within the band of the surface");
  return MakeLevelSet(grid);
}

LevelSet FromMesh(const py::dict& fields, double voxel_size, const std::string& sign, double half_width_voxels) {
  const TriangleMesh mesh = MeshOf(fields);
  SdfOptions options;
  options.sign = sign;
  options.half_width_voxels = half_width_voxels;
  return InBackground(py::none(), [&](Progress&) { return MeshToLevelSet(mesh, voxel_size, options); });
}

// get(x) at every point, in parallel; rows of D numbers.
template <int D, class Get>
Array<double> Sample(const LevelSet& level_set, const Array<double>& points, const Get& get) {
  if (level_set.empty()) throw InputError("", "level set", "is empty");
  const auto at = RowsOf<Eigen::Vector3d>(points);
  std::vector<Eigen::Matrix<double, D, 1>> values(at.size());
  InBackground(py::none(), [&](Progress& progress) {
    ParallelChunks(at.size(), 1024, [&](size_t begin, size_t end) {
      progress.ThrowIfCancelled();
      for (size_t i = begin; i < end; ++i) values[i] = get(at[i]);
    });
  });
  return ArrayOf(values);
}

}  // namespace

void BindLevelSet(py::module_& m) {
  openvdb::initialize();
  py::class_<LevelSet>(m, "LevelSet",
                       "A narrow-band signed distance field in world units, negative inside (OpenVDB within).")
      .def_property_readonly("voxel_size", &LevelSet::voxel_size, "Edge of a voxel, world units.")
      .def_property_readonly("half_width_voxels", &LevelSet::half_width_voxels, "Half width of the band, voxels.")
      .def_property_readonly("num_active_voxels", &LevelSet::num_active_voxels, "Voxels in the band.")
      .def_property_readonly("memory_bytes", &LevelSet::memory_bytes, "Memory of the grid.")
      .def(
          "_values",
          [](const LevelSet& self, const Array<double>& points) {
            return Sample<1>(self, points, [&](const auto& x) { return Eigen::Matrix<double, 1, 1>(self.Value(x)); });
          },
          py::arg("points"))
      .def(
          "_gradients",
          [](const LevelSet& self, const Array<double>& points) {
            return Sample<3>(self, points, [&](const auto& x) { return self.Gradient(x); });
          },
          py::arg("points"))
      .def("_to_dense", &ToDense);
  m.def(
      "read_level_set",
      [](const std::string& path) { return InBackground(py::none(), [&](Progress&) { return ReadVdb(path); }); },
      py::arg("path"));
  m.def(
      "write_level_set",
      [](const std::string& path, const LevelSet& level_set) {
        if (level_set.empty()) throw InputError(path, "", "the level set is empty");
        InBackground(py::none(), [&](Progress&) { WriteVdb(path, level_set); });
      },
      py::arg("path"), py::arg("level_set"));
  m.def("mesh_to_level_set", &FromMesh, py::arg("mesh"), py::arg("voxel_size"), py::arg("sign"),
        py::arg("half_width_voxels"));
  m.def(
      "dense_to_level_set",
      [](const Array<float>& values, const std::array<double, 3>& origin, double voxel_size, double half_width_voxels) {
        return FromDense(values, {origin[0], origin[1], origin[2]}, voxel_size, half_width_voxels);
      },
      py::arg("values"), py::arg("origin"), py::arg("voxel_size"), py::arg("half_width_voxels"));
  m.def(
      "level_set_to_mesh",
      [](const LevelSet& level_set, double iso) {
        if (level_set.empty()) throw InputError("", "level set", "is empty");
        return DictOf(InBackground(py::none(), [&](Progress&) { return ExtractMesh(level_set, iso); }));
      },
      py::arg("level_set"), py::arg("iso"));
}

}  // namespace glint::python
