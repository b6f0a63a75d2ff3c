#include "seed/sparse_cells.h"

namespace glint {

SparseCells BuildSparseCells(const Scene& scene, const std::vector<SparseVertex>& vertices,
                             const std::vector<int>& context, std::vector<FreeLine> free_lines,
                             const std::vector<MatterBehind>& matter) {
  std::vector<Eigen::Vector3d> centers, positions;
  for (const View& view : scene.views) centers.push_back(view.Center());
  std::vector<SightLine> lines;
  std::vector<double> sigma;
  SparseCells out;
  for (size_t i = 0; i < vertices.size(); ++i) {
    positions.push_back(vertices[i].position);
    sigma.push_back(vertices[i].sigma);
    out.scene_point.push_back(vertices[i].scene_point);
    if (vertices[i].scene_point < 0) continue;
    for (const Observation& o : scene.points[vertices[i].scene_point].observations)
      lines.push_back({static_cast<int>(i), centers[o.view]});
  }
  for (int point : context)
    for (const Observation& o : scene.points[point].observations)
      free_lines.push_back({scene.points[point].position, centers[o.view]});
  out.tetrahedra = DelaunayTetrahedra(positions);
  out.votes = CastVotes(out.tetrahedra, lines, sigma, free_lines, matter);
  return out;
}

}  // namespace glint
