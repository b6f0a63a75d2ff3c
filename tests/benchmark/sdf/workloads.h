// What is measured.
#pragma once

#include <string>
#include <vector>

#include "geometry/triangle_mesh.h"
#include "tests/benchmark/sdf/subject.h"
#include "tests/benchmark/sdf/table.h"

namespace glint::benchmark {

struct RunOptions {
  std::vector<std::string> peers = {"openvdb", "embree", "cgal"};
  size_t peer_voxels = 200'000;
  double check_pairs = 1e9;
  size_t check_signs = 1'000'000;
  int repeats = 3;
};

// Where the mesh is put: scaled, then moved by so many diagonals.
struct Placement {
  double scale = 1, offset_diagonals = 0;
};

// Rows of all `work` on one mesh. Throws InputError for work that it does not know.
void RunMesh(const std::string& name, TriangleMesh mesh, const std::vector<std::string>& work,
             const Placement& placement, const RunOptions& options, Table& table);

// Parts of it: a narrow band at so many voxels along the longest side; points about the mesh; a dense grid of n³.
Work RunBand(const Subject& subject, int resolution, double half_width, const RunOptions& options);
Work RunScattered(const Subject& subject, size_t count, const RunOptions& options);
Work RunDense(const Subject& subject, int n, const RunOptions& options);

}  // namespace glint::benchmark
