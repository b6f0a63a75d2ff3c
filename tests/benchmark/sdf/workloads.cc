#include "tests/benchmark/sdf/workloads.h"

#include <fmt/format.h>

#include <cstdio>

#include "core/error.h"

namespace glint::benchmark {

namespace {

std::string NameAt(const std::string& name, const Placement& at) {
  std::string text = name;
  if (at.scale != 1) text += fmt::format(" ×{:g}", at.scale);
  if (at.offset_diagonals != 0) text += fmt::format(" +{:g}", at.offset_diagonals);
  return text;
}

}  // namespace

void RunMesh(const std::string& name, TriangleMesh mesh, const std::vector<std::string>& work,
             const Placement& placement, const RunOptions& options, Table& table) {
  const double diagonal = Diagonal(mesh);
  for (Eigen::Vector3d& v : mesh.vertices)
    v = placement.scale * v + placement.scale * placement.offset_diagonals * diagonal * Eigen::Vector3d(1, -0.7, 0.3);
  Subject subject(NameAt(name, placement), std::move(mesh));
  for (const std::string& peer : options.peers) {
    if (peer == "embree") subject.peers.push_back(MakeEmbreePeer(subject.mesh, subject.normals));
    if (peer == "cgal") subject.peers.push_back(MakeCgalPeer(subject.mesh, subject.normals));
  }
  for (const std::string& w : work) {
    int n = 0;
    double half_width = 3;
    if (std::sscanf(w.c_str(), "band:%d:%lf", &n, &half_width) == 2 && n > 0) {
      table.Add(RunBand(subject, n, half_width, options));
    } else if (std::sscanf(w.c_str(), "dense:%d", &n) == 1 && n > 0) {
      table.Add(RunDense(subject, n, options));
    } else if (std::sscanf(w.c_str(), "points:%d", &n) == 1 && n > 0) {
      table.Add(RunScattered(subject, static_cast<size_t>(n), options));
    } else {
      throw InputError("", w, "expected band:RESOLUTION:HALF_WIDTH, dense:N or points:N");
    }
  }
}

}  // namespace glint::benchmark
