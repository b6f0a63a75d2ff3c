#include "tests/benchmark/scenes/baselines.h"

#include "refine/flow_step.h"
#include "refine/normalized.h"
#include "sdf/extract_mesh.h"
#include "sdf/mesh_to_level_set.h"
#include "tests/benchmark/seeds/poisson_peer.h"

namespace glint::benchmark {

std::vector<TriangleMesh> LaplacianSmoothed(const TriangleMesh& mesh) {
  std::vector<TriangleMesh> smoothed;
  TriangleMesh now{mesh.vertices, mesh.faces, {}, {}, {}, {}};
  int done = 0;
  for (const int rounds : {0, 1, 2, 5, 10, 20, 50}) {
    for (; done < rounds; ++done) {
      std::vector<Eigen::Vector3d> sum(now.vertices.size(), Eigen::Vector3d::Zero());
      std::vector<int> count(now.vertices.size(), 0);
      for (const Eigen::Vector3i& f : now.faces)
        for (int k = 0; k < 3; ++k) {
          sum[f[k]] += now.vertices[f[(k + 1) % 3]] + now.vertices[f[(k + 2) % 3]];
          count[f[k]] += 2;
        }
      for (size_t v = 0; v < sum.size(); ++v)
        if (count[v] > 0) now.vertices[v] = 0.5 * (now.vertices[v] + sum[v] / count[v]);
    }
    smoothed.push_back(now);
  }
  return smoothed;
}

std::vector<TriangleMesh> CurvatureFlowed(const TriangleMesh& mesh, double voxel_rel) {
  const UnitFrame frame = UnitFrame::Of(mesh);
  const TriangleMesh unit = frame.FromWorld(TriangleMesh{mesh.vertices, mesh.faces, {}, {}, {}, {}});
  LevelSet surface = MeshToLevelSet(unit, voxel_rel, {});
  FlowOptions options;
  options.alignment = options.points = options.force = 0;
  options.curvature = 1;
  std::vector<TriangleMesh> flowed;
  int done = 0;
  for (const int steps : {10, 30, 100, 300}) {
    options.max_steps = steps - done;
    done = steps;
    const LevelSet start = surface;
    surface = FlowStep({start, start, Bend::kFlat, 1, {}, {}, {}}, options, nullptr);
    const TriangleMesh extracted = ExtractMesh(surface);
    if (extracted.faces.empty()) break;
    flowed.push_back(frame.ToWorld(extracted));
  }
  return flowed;
}

TriangleMesh Poisson(const Scene& scene, const std::vector<uint8_t>& used) {
  std::vector<Eigen::Vector3d> points, toward;
  for (size_t i = 0; i < scene.points.size(); ++i) {
    if (!used[i]) continue;
    points.push_back(scene.points[i].position);
    toward.push_back(TowardViews(scene, scene.points[i]));
  }
  return PoissonSurface(points, toward);
}

}  // namespace glint::benchmark
