#include "metrics/surface_samples.h"

#include <cmath>
#include <tuple>

namespace glint {

std::vector<AreaSample> SampleSurface(const TriangleMesh& mesh, int count) {
  std::vector<double> cumulative(mesh.faces.size());
  double area = 0;
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& [a, b, c] =
        std::tie(mesh.vertices[mesh.faces[f][0]], mesh.vertices[mesh.faces[f][1]], mesh.vertices[mesh.faces[f][2]]);
    area += 0.5 * (b - a).cross(c - a).norm();
    cumulative[f] = area;
  }
  std::vector<AreaSample> samples;
  if (!(area > 0) || count <= 0) return samples;
  samples.reserve(count);
  size_t f = 0;
  for (int i = 0; i < count; ++i) {
    const double at = (i + 0.5) / count * area;
    while (f + 1 < mesh.faces.size() && cumulative[f] <= at) ++f;
    double u = std::fmod(0.5 + 0.7548776662466927 * i, 1.0);  // R2 sequence
    double v = std::fmod(0.5 + 0.5698402909980532 * i, 1.0);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const Eigen::Vector3d w(1 - u - v, u, v);
    const Eigen::Vector3i& face = mesh.faces[f];
    samples.push_back({w[0] * mesh.vertices[face[0]] + w[1] * mesh.vertices[face[1]] + w[2] * mesh.vertices[face[2]], w,
                       static_cast<int>(f)});
  }
  return samples;
}

}  // namespace glint
