#include "pipeline/error_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/check.h"
#include "metrics/compare.h"
#include "sdf/signed_distance.h"

namespace glint {
namespace {

// Nine tenths of the surface are triangles without a longer edge.
bool MostlyShort(const TriangleMesh& mesh, double edge) {
  double total = 0, longer = 0;
  for (const Eigen::Vector3i& f : mesh.faces) {
    const auto at = [&](int k) -> const Eigen::Vector3d& { return mesh.vertices[static_cast<size_t>(f[k % 3])]; };
    const double area = (at(1) - at(0)).cross(at(2) - at(0)).norm();
    double longest = 0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, (at(k + 1) - at(k)).norm());
    total += area;
    if (longest > edge) longer += area;
  }
  return longer <= 0.1 * total;
}

}  // namespace

ErrorField MeasureErrors(const TriangleMesh& mesh, const TriangleMesh& reference) {
  const double diagonal = Diagonal(reference);
  ErrorField field;
  field.signed_rel = SignedDistance(reference, mesh.vertices);
  for (double& d : field.signed_rel) d /= diagonal;
  field.area.assign(mesh.vertices.size(), 0);
  for (const Eigen::Vector3i& face : mesh.faces) {
    const auto corner = [&](int k) -> const Eigen::Vector3d& { return mesh.vertices[static_cast<size_t>(face[k])]; };
    const double area = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    for (int k = 0; k < 3; ++k) field.area[static_cast<size_t>(face[k])] += area / 3;
  }
  return field;
}

TriangleMesh Divided(const TriangleMesh& mesh, double edge, size_t max_faces) {
  TriangleMesh out;
  out.vertices = mesh.vertices;
  out.faces = mesh.faces;
  while (4 * out.faces.size() <= max_faces && !MostlyShort(out, edge)) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [entry, added] = middles.try_emplace(std::minmax(a, b), static_cast<int>(out.vertices.size()));
      if (added)
        out.vertices.push_back((out.vertices[static_cast<size_t>(a)] + out.vertices[static_cast<size_t>(b)]) / 2);
      return entry->second;
    };
    std::vector<Eigen::Vector3i> faces;
    for (const Eigen::Vector3i& f : out.faces) {
      const int a = middle(f[0], f[1]), b = middle(f[1], f[2]), c = middle(f[2], f[0]);
      for (const Eigen::Vector3i& part : {Eigen::Vector3i(f[0], a, c), Eigen::Vector3i(f[1], b, a),
                                          Eigen::Vector3i(f[2], c, b), Eigen::Vector3i(a, b, c)})
        faces.push_back(part);
    }
    out.faces = std::move(faces);
  }
  return out;
}

ErrorHistogram HistogramOf(const ErrorField& field, double largest_rel, int num_bins) {
  GLINT_CHECK_GT(largest_rel, 0);
  ErrorHistogram histogram{largest_rel, std::vector<double>(static_cast<size_t>(num_bins), 0)};
  double total = 0;
  for (double area : field.area) total += area;
  if (!(total > 0)) return histogram;
  for (size_t v = 0; v < field.signed_rel.size(); ++v) {
    const double share = field.area[v] / total, at = (field.signed_rel[v] / largest_rel + 1) / 2;
    if (at < 0) {
      histogram.below += share;
    } else if (at > 1) {
      histogram.above += share;
    } else {
      histogram.shares[std::min(static_cast<size_t>(at * num_bins), histogram.shares.size() - 1)] += share;
    }
  }
  return histogram;
}

double RoundErrorRange(const std::vector<ErrorField>& fields) {
  double largest = 1e-9;  // of two meshes that are the same
  for (const ErrorField& field : fields) {
    std::vector<double> sizes;
    for (double d : field.signed_rel) sizes.push_back(std::abs(d));
    largest = std::max(largest, StatsOf(std::move(sizes)).p95);
  }
  const double power = std::pow(10.0, std::floor(std::log10(largest)));
  for (double step : {1.0, 2.0, 5.0})
    if (largest <= step * power * (1 + 1e-9)) return step * power;
  return 10 * power;
}

std::array<uint8_t, 3> SignedErrorColor(double error, double largest) {
  static constexpr double kStops[5][3] = {
      {31, 95, 176}, {143, 189, 224}, {241, 239, 234}, {238, 176, 122}, {179, 71, 27}};
  const double position = 4 * std::clamp(0.5 + 0.5 * error / largest, 0.0, 1.0);
  const int below = std::min(static_cast<int>(position), 3);
  std::array<uint8_t, 3> color{};
  for (size_t c = 0; c < 3; ++c)
    color[c] = static_cast<uint8_t>(
        std::lround(kStops[below][c] + (position - below) * (kStops[below + 1][c] - kStops[below][c])));
  return color;
}

TriangleMesh ColoredByError(TriangleMesh mesh, const ErrorField& field, double reference_diagonal, double largest_rel) {
  GLINT_CHECK_EQ(field.signed_rel.size(), mesh.vertices.size());
  mesh.colors.clear();
  std::vector<float> quality;
  for (double d : field.signed_rel) {
    mesh.colors.push_back(SignedErrorColor(d, largest_rel));
    quality.push_back(static_cast<float>(d * reference_diagonal));
  }
  std::erase_if(mesh.scalars, [](const auto& scalar) { return scalar.first == "quality"; });
  mesh.scalars.emplace_back("quality", std::move(quality));
  return mesh;
}

}  // namespace glint
