#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/parallel.h"
#include "geometry/closest_point.h"
#include "geometry/curvature.h"
#include "geometry/simplify.h"
#include "pipeline/comparison.h"
#include "pipeline/page_parts.h"
#include "sdf/signed_distance.h"

namespace glint {
namespace {

constexpr size_t kGrain = 1024;

template <class T>
std::string Base64Of(const std::vector<T>& values) {
  return Base64({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
}

// [0, 1] on 16 bits.
uint16_t Unit16(double value) { return static_cast<uint16_t>(std::lround(65535 * std::clamp(value, 0.0, 1.0))); }

// A unit vector as a point of an octahedron's unfolded faces (Meyer et al. 2010), each coordinate [-1, 1] on 16 bits.
std::array<int16_t, 2> Octahedral(const Eigen::Vector3d& n) {
  const double sum = n.cwiseAbs().sum();
  if (!(sum > 0)) return {0, 0};
  Eigen::Vector2d p = n.head<2>() / sum;
  if (n.z() < 0) {
    const Eigen::Vector2d folded(1 - std::abs(p.y()), 1 - std::abs(p.x()));
    p = {std::copysign(folded.x(), p.x()), std::copysign(folded.y(), p.y())};
  }
  return {static_cast<int16_t>(std::lround(32767 * p.x())), static_cast<int16_t>(std::lround(32767 * p.y()))};
}

// Attribute values in their range; with `tail` the range leaves out that share of the values at either end.
Json Attribute(const std::vector<double>& values, double tail = 0) {
  std::vector<double> sorted;
  for (double v : values)
    if (std::isfinite(v)) sorted.push_back(v);
  if (sorted.empty()) sorted.push_back(0);
  std::sort(sorted.begin(), sorted.end());
  const auto skip = static_cast<size_t>(tail * static_cast<double>(sorted.size() - 1));
  const double low = sorted[skip], high = sorted[sorted.size() - 1 - skip];
  std::vector<uint16_t> packed(values.size());
  for (size_t i = 0; i < values.size(); ++i)
    packed[i] = high > low && !std::isnan(values[i]) ? Unit16((values[i] - low) / (high - low)) : uint16_t{0};
  return {{"min", low}, {"max", high}, {"data", Base64Of(packed)}};
}

std::vector<double> ToDouble(const std::vector<float>& values) { return {values.begin(), values.end()}; }

// The simplified mesh with what the full one knows at the closest points.
TriangleMesh SimplifiedWithAttributes(const TriangleMesh& full, size_t max_faces) {
  TriangleMesh out = Simplify(full, max_faces);
  const ClosestPointQuery query(full);
  const size_t n = out.vertices.size();
  out.normals.resize(n);
  if (!full.confidence.empty()) out.confidence.resize(n);
  if (!full.colors.empty()) out.colors.resize(n);
  for (const auto& [name, values] : full.scalars) out.scalars.emplace_back(name, std::vector<float>(n));
  ParallelFor(n, kGrain, [&](size_t v) {
    const MeshPoint at = *query.Find(out.vertices[v]);
    const Eigen::Vector3i& face = full.faces[static_cast<size_t>(at.face)];
    const auto corner = [&](int k) { return static_cast<size_t>(face[k]); };
    const Eigen::Vector3d weights =
        Barycentric(full.vertices[corner(0)], full.vertices[corner(1)], full.vertices[corner(2)], at.point);
    const auto mix = [&](const std::vector<float>& values) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) sum += weights[k] * values[corner(k)];
      return static_cast<float>(sum);
    };
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) normal += weights[k] * full.normals[corner(k)];
    out.normals[v] = normal.normalized();
    if (!full.confidence.empty()) out.confidence[v] = mix(full.confidence);
    int nearest = 0;
    weights.maxCoeff(&nearest);
    if (!full.colors.empty()) out.colors[v] = full.colors[corner(nearest)];
    for (size_t s = 0; s < full.scalars.size(); ++s) out.scalars[s].second[v] = mix(full.scalars[s].second);
  });
  return out;
}

Json Geometry(const TriangleMesh& mesh, const PageFrame& frame) {
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  const Eigen::Vector3d low = frame.FromWorld(box.min()), size = box.sizes() / frame.diagonal;
  std::vector<uint16_t> positions;
  std::vector<int16_t> normals;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Eigen::Vector3d x = frame.FromWorld(mesh.vertices[v]) - low;
    for (int k = 0; k < 3; ++k) positions.push_back(size[k] > 0 ? Unit16(x[k] / size[k]) : uint16_t{0});
    for (int16_t coordinate : Octahedral(mesh.normals[v])) normals.push_back(coordinate);
  }
  std::vector<uint32_t> faces;
  for (const Eigen::Vector3i& face : mesh.faces)
    for (int k = 0; k < 3; ++k) faces.push_back(static_cast<uint32_t>(face[k]));
  return {{"min", {low.x(), low.y(), low.z()}},
          {"size", {size.x(), size.y(), size.z()}},
          {"positions", Base64Of(positions)},
          {"normals", Base64Of(normals)},
          {"faces", Base64Of(faces)}};
}

}  // namespace

Json PageMesh(const TriangleMesh& mesh, const TriangleMesh& other, const PageFrame& frame, size_t max_faces) {
  if (mesh.empty()) return nullptr;
  TriangleMesh shown = WithoutUnusedVertices(mesh);
  EnsureNormals(shown);
  const std::vector<double> curvature = MeanCurvature(shown);
  // Curvature of the full mesh: a simplified one has lost its detail.
  std::vector<float>& kept = shown.scalars.emplace_back("curvature", std::vector<float>{}).second;
  for (double c : curvature) kept.push_back(static_cast<float>(c * frame.diagonal));
  if (shown.faces.size() > max_faces) shown = SimplifiedWithAttributes(shown, max_faces);

  Json json = {{"vertices", shown.vertices.size()},
               {"faces", shown.faces.size()},
               {"full_vertices", mesh.vertices.size()},
               {"full_faces", mesh.faces.size()}};
  json["geometry"] = Geometry(shown, frame);
  if (!shown.colors.empty()) {
    std::string rgb;
    for (const std::array<uint8_t, 3>& color : shown.colors) rgb.append(color.begin(), color.end());
    json["colors"] = Base64(rgb);
  }
  Json& attributes = json["attributes"] = Json::object();
  if (!shown.confidence.empty()) attributes["confidence"] = Attribute(ToDouble(shown.confidence));
  for (const auto& [name, values] : shown.scalars)
    if (name == "curvature") attributes[name] = Attribute(ToDouble(values), 0.005);
  for (const auto& [name, values] : shown.scalars)
    if (name == "sigma_normal_deg" || name == "sigma_position_rel") attributes[name] = Attribute(ToDouble(values));
  if (!other.empty()) {
    std::vector<double> moved = SignedDistance(other, shown.vertices);
    for (double& d : moved) d /= frame.diagonal;
    attributes["moved_rel"] = Attribute(moved);
  }
  return json;
}

}  // namespace glint
