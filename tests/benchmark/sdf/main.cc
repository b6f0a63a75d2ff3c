// Signed distance by Glint and by its peers, side by side: one table. Examples:
//   sdf_benchmark                                        a minute: spot and a spiky sphere at 256³
//   sdf_benchmark --mesh all --work band:512:3           every mesh at 512³ voxels
//   sdf_benchmark --mesh spot.obj smooth:3000000 --work band:1024:3 band:256:10 dense:128 points:1000000
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "tests/benchmark/sdf/growth.h"
#include "tests/benchmark/sdf/meshes.h"
#include "tests/benchmark/sdf/pictures.h"
#include "tests/benchmark/sdf/workloads.h"

int main(int argc, char** argv) {
  using namespace glint;
  using namespace glint::benchmark;
  CLI::App app("Signed distance: Glint beside OpenVDB, Embree and CGAL");
  std::string folder = GLINT_SOURCE_DIR "/../shared/data/meshes";
  std::vector<std::string> meshes = {"spot.obj", "spiky:20000"}, work = {"band:256:3", "band:128:10", "points:200000"};
  RunOptions options;
  bool floor = true;
  int threads = 0;
  std::string pictures, growth;
  app.add_option("--folder", folder, "Where the meshes are")->capture_default_str();
  app.add_option("--mesh", meshes, "Files, smooth:N, scan:N, spiky:N; all: the default set")->capture_default_str();
  app.add_option("--work", work, "band:RESOLUTION:HALF_WIDTH, dense:N, points:N")->capture_default_str();
  app.add_option("--peers", options.peers, "Which to run beside Glint: any of openvdb embree cgal")->expected(0, 3);
  app.add_option("--peer-voxels", options.peer_voxels, "Exact peers do at most this many voxels of a workload");
  app.add_option("--pairs", options.check_pairs, "Voxels times triangles to spend on brute force, a field; 0: none");
  app.add_option("--signs", options.check_signs, "Voxels whose sign is checked, a field; 0: none");
  app.add_option("--repeats", options.repeats, "The fastest of so many runs counts");
  app.add_option("--threads", threads, "0: as many as there are cores");
  app.add_option("--scale", options.scale, "Multiply the coordinates by this");
  app.add_option("--offset", options.offset_diagonals, "Then move the mesh by so many diagonals");
  app.add_flag("!--no-floor", floor, "Do not measure the floor");
  app.add_option("--pictures", pictures, "Only write the pictures of the documentation into this folder");
  app.add_option("--growth", growth, "Only measure the growth with triangles and voxels, and plot it into this PNG");
  CLI11_PARSE(app, argc, argv);
  try {
    const ThreadLimit limit(threads);
    if (!growth.empty()) {
      PlotGrowth(growth);
      return 0;
    }
    if (!pictures.empty()) {
      WritePictures(pictures);
      return 0;
    }
    if (meshes == std::vector<std::string>{"all"}) meshes = DefaultMeshes(folder);
    PrintHeader();
    for (const std::string& name : meshes) {
      if (name.find(':') == std::string::npos && !std::filesystem::exists(name) &&
          !std::filesystem::exists(std::filesystem::path(folder) / name)) {
        fmt::print("{}: not there, left out\n", name);
        continue;
      }
      RunMesh(name, MakeMesh(name, folder), work, options);
    }
    if (floor) PrintFloor();
  } catch (const InputError& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 2;
  }
  return 0;
}
