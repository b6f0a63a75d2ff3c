// What is measured, and its table.
#pragma once

#include <string>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint::benchmark {

struct RunOptions {
  std::vector<std::string> peers = {"openvdb", "embree", "cgal"};
  size_t peer_voxels = 500'000;
  double check_pairs = 5e8;
  size_t check_signs = 2'000'000;
  int repeats = 3;
  double scale = 1, offset_diagonals = 0;
};

void PrintHeader();

// Rows of all `work` on one mesh. Throws InputError for work that it does not know.
void RunMesh(const std::string& name, TriangleMesh mesh, const std::vector<std::string>& work,
             const RunOptions& options);

// What the same leaves cost without any distances, and the kernel without the rest.
void PrintFloor();

}  // namespace glint::benchmark
