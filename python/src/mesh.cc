// Meshes, signed distance at points, and the comparison of meshes.
#include <pybind11/stl.h>

#include <algorithm>

#include "arrays.h"
#include "background.h"
#include "bindings.h"
#include "core/error.h"
#include "core/parallel.h"
#include "io/mesh_io.h"
#include "metrics/align.h"
#include "metrics/compare.h"
#include "sdf/signed_distance.h"

namespace glint::python {

py::dict DictOf(const TriangleMesh& mesh) {
  py::dict fields;
  fields["vertices"] = ArrayOf(mesh.vertices);
  fields["faces"] = ArrayOf(mesh.faces);
  fields["normals"] = mesh.normals.empty() ? py::object(py::none()) : ArrayOf(mesh.normals);
  fields["colors"] = mesh.colors.empty()
                         ? py::object(py::none())
                         : ArrayOfRows<3, uint8_t>(mesh.colors, [](const auto& color) { return color; });
  py::dict attributes;
  if (!mesh.confidence.empty()) attributes["confidence"] = ArrayOfScalars(mesh.confidence);
  for (const auto& [name, values] : mesh.scalars) attributes[name.c_str()] = ArrayOfScalars(values);
  fields["attributes"] = attributes;
  return fields;
}

TriangleMesh MeshOf(const py::dict& fields) {
  TriangleMesh mesh;
  mesh.vertices = RowsOf<Eigen::Vector3d>(fields["vertices"].cast<Array<double>>());
  mesh.faces = RowsOf<Eigen::Vector3i>(fields["faces"].cast<Array<int>>());
  if (!fields["normals"].is_none()) mesh.normals = RowsOf<Eigen::Vector3d>(fields["normals"].cast<Array<double>>());
  if (!fields["colors"].is_none())
    for (const auto& c : RowsOf<Eigen::Matrix<uint8_t, 3, 1>>(fields["colors"].cast<Array<uint8_t>>()))
      mesh.colors.push_back({c[0], c[1], c[2]});
  for (const auto& [key, value] : fields["attributes"].cast<py::dict>()) {
    const auto array = value.cast<Array<float>>();
    std::vector<float> values(array.data(), array.data() + array.size());
    const auto name = key.cast<std::string>();
    if (name == "confidence")
      mesh.confidence = std::move(values);
    else
      mesh.scalars.emplace_back(name, std::move(values));
  }
  return mesh;
}

namespace {

constexpr size_t kGrain = 256;

std::vector<SignedDistanceQuery::Result> FindAll(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& points,
                                                 const std::string& sign, std::string& method, Progress& progress) {
  const SignedDistanceQuery query(mesh, sign);
  method = query.method();
  std::vector<SignedDistanceQuery::Result> results(points.size());
  ParallelChunks(points.size(), kGrain, [&](size_t begin, size_t end) {
    progress.ThrowIfCancelled();
    for (size_t i = begin; i < end; ++i) results[i] = query.FindClosest(points[i]);
  });
  return results;
}

// In blocks, between which Ctrl-C is heard.
std::vector<double> DistancesOf(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& points,
                                const std::string& sign, Progress& progress) {
  constexpr size_t kBlock = 1 << 17;
  const SignedDistanceQuery query(mesh, sign);
  std::vector<double> distances;
  distances.reserve(points.size());
  for (size_t begin = 0; begin < points.size(); begin += kBlock) {
    progress.ThrowIfCancelled();
    const auto first = points.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = points.begin() + static_cast<std::ptrdiff_t>(std::min(points.size(), begin + kBlock));
    const std::vector<double> block = query.Distances({first, last});
    distances.insert(distances.end(), block.begin(), block.end());
  }
  return distances;
}

Array<double> SignedDistance(const py::dict& fields, const Array<double>& points, const std::string& sign) {
  const TriangleMesh mesh = MeshOf(fields);
  const auto at = RowsOf<Eigen::Vector3d>(points);
  return ArrayOfScalars(
      InBackground(py::none(), [&](Progress& progress) { return DistancesOf(mesh, at, sign, progress); }));
}

py::dict ClosestPoints(const py::dict& fields, const Array<double>& points, const std::string& sign) {
  const TriangleMesh mesh = MeshOf(fields);
  const auto at = RowsOf<Eigen::Vector3d>(points);
  std::string method;
  const auto found =
      InBackground(py::none(), [&](Progress& progress) { return FindAll(mesh, at, sign, method, progress); });
  using Result = SignedDistanceQuery::Result;
  py::dict result;
  result["distance"] = ArrayOfEach<double>(found, [](const Result& r) { return r.distance; });
  result["face"] = ArrayOfEach<int64_t>(found, [](const Result& r) { return r.closest.face; });
  result["point"] = ArrayOfRows<3, double>(found, [](const Result& r) { return r.closest.point; });
  result["barycentric"] = ArrayOfRows<3, double>(found, [](const Result& r) { return r.barycentric; });
  result["sign"] = method;
  return result;
}

py::dict DictOf(const ErrorStats& stats) {
  py::dict d;
  d["count"] = stats.count;
  d["mean"] = stats.mean;
  d["rms"] = stats.rms;
  d["median"] = stats.median;
  d["p95"] = stats.p95;
  d["max"] = stats.max;
  return d;
}

py::dict Compare(const py::dict& mesh_fields, const py::dict& reference_fields, const CompareOptions& options,
                 const py::object& mask, const py::object& callback) {
  const TriangleMesh mesh = MeshOf(mesh_fields), reference = MeshOf(reference_fields);
  std::vector<uint8_t> where;
  if (!mask.is_none()) {
    const auto array = mask.cast<Array<uint8_t>>();
    where.assign(array.data(), array.data() + array.size());
  }
  const MeshComparison found = InBackground(
      callback, [&](Progress& progress) { return CompareMeshes(mesh, reference, options, where, progress); });
  py::dict result;
  result["reference_diagonal"] = found.reference_diagonal;
  result["accuracy"] = DictOf(found.accuracy);
  result["completeness"] = DictOf(found.completeness);
  result["chamfer"] = found.chamfer;
  result["normal_deg"] = DictOf(found.normal_deg);
  result["f_scores"] = ArrayOfRows<4, double>(
      found.f_scores, [](const FScore& s) { return Eigen::Vector4d(s.threshold_rel, s.precision, s.recall, s.f); });
  result["mesh_distance"] = ArrayOfScalars(found.mesh_distance);
  result["reference_distance"] = ArrayOfScalars(found.reference_distance);
  result["reference_normal_deg"] = ArrayOfScalars(found.reference_normal_deg);
  return result;
}

py::dict Align(const py::dict& mesh_fields, const py::dict& reference_fields, bool with_scale,
               const py::object& callback) {
  const TriangleMesh mesh = MeshOf(mesh_fields), reference = MeshOf(reference_fields);
  for (const auto& [name, surface] : {std::pair("mesh", &mesh), std::pair("reference", &reference)})
    if (!(SurfaceArea(*surface) > 0))
      throw InputError(name, name, "expected a surface, found no triangle with an area");
  const Alignment found = InBackground(callback, [&](Progress& progress) {
    return AlignMeshes(mesh, reference, with_scale, Eigen::Affine3d::Identity(), progress);
  });
  py::dict result;
  const Eigen::Matrix4d matrix = found.reference_from_mesh.matrix();
  result["reference_from_mesh"] =
      ArrayOfRows<4, double>(std::vector<int>{0, 1, 2, 3}, [&](int row) { return Eigen::Vector4d(matrix.row(row)); });
  result["scale"] = found.scale;
  result["mean_rel"] = found.mean_rel;
  return result;
}

}  // namespace

void BindMesh(py::module_& m) {
  m.def(
      "read_mesh",
      [](const std::string& path) {
        return DictOf(InBackground(py::none(), [&](Progress&) { return ReadMesh(path); }));
      },
      py::arg("path"));
  m.def(
      "write_mesh",
      [](const std::string& path, const py::dict& mesh) {
        const TriangleMesh written = MeshOf(mesh);
        InBackground(py::none(), [&](Progress&) { WriteMesh(path, written); });
      },
      py::arg("path"), py::arg("mesh"));
  m.def("signed_distance", &SignedDistance, py::arg("mesh"), py::arg("points"), py::arg("sign"));
  m.def("closest_points", &ClosestPoints, py::arg("mesh"), py::arg("points"), py::arg("sign"));
  m.def("align", &Align, py::arg("mesh"), py::arg("reference"), py::arg("with_scale"), py::arg("progress"));
  m.def(
      "compare",
      [](const py::dict& mesh, const py::dict& reference, int num_samples, const std::vector<double>& f_thresholds_rel,
         const py::object& mask, const py::object& progress) {
        return Compare(mesh, reference, {num_samples, f_thresholds_rel}, mask, progress);
      },
      py::arg("mesh"), py::arg("reference"), py::arg("num_samples"), py::arg("f_thresholds_rel"), py::arg("mask"),
      py::arg("progress"));
}

}  // namespace glint::python
