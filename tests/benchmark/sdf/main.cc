// Signed distance by Glint and by its peers, side by side: one table. Examples:
//   sdf_benchmark                                        a choice of everything, in a few minutes
//   sdf_benchmark --full                                 everything
//   sdf_benchmark --mesh spot.obj smooth:3000000 --work band:1024:3 band:256:10 dense:128 points:1000000
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "tests/benchmark/sdf/floor.h"
#include "tests/benchmark/sdf/growth.h"
#include "tests/benchmark/sdf/meshes.h"
#include "tests/benchmark/sdf/pictures.h"
#include "tests/benchmark/sdf/plan.h"

namespace {

using namespace glint;
using namespace glint::benchmark;

struct Arguments {
  std::string folder = GLINT_SOURCE_DIR "/../shared/data/meshes", pictures, growth;
  std::vector<std::string> meshes, work = {"band:256:3"};
  Placement placement;
  RunOptions options;
  bool full = false, floor = true;
  int threads = 0;
};

void Declare(CLI::App& app, Arguments& a) {
  app.add_flag("--full", a.full, "Everything: about an hour");
  auto* mesh = app.add_option("--mesh", a.meshes, "Only these: files, smooth:N, scan:N, spiky:N");
  app.add_option("--work", a.work, "Of these meshes: band:RESOLUTION:HALF_WIDTH, dense:N, points:N")
      ->needs(mesh)
      ->capture_default_str();
  app.add_option("--scale", a.placement.scale, "Multiply their coordinates by this")->needs(mesh);
  app.add_option("--offset", a.placement.offset_diagonals, "Then move them by so many diagonals")->needs(mesh);
  app.add_option("--folder", a.folder, "Where the meshes are")->capture_default_str();
  app.add_option("--peers", a.options.peers, "Which to run beside Glint: any of openvdb embree cgal")->expected(0, 3);
  app.add_option("--peer-voxels", a.options.peer_voxels, "Exact peers do at most this many voxels of a workload");
  app.add_option("--pairs", a.options.check_pairs, "Voxels times triangles to spend on brute force, a field; 0: none");
  app.add_option("--signs", a.options.check_signs, "Voxels whose sign is checked, a field; 0: none");
  app.add_option("--repeats", a.options.repeats, "The fastest of so many runs counts");
  app.add_option("--threads", a.threads, "0: as many as there are cores");
  app.add_flag("!--no-floor", a.floor, "Do not measure floor and memory");
  app.add_option("--pictures", a.pictures, "Only write the pictures of the documentation into this folder");
  app.add_option("--growth", a.growth, "Only measure the growth with triangles and voxels, and plot it into this PNG");
}

void RunPlan(const Arguments& a) {
  std::vector<PlanItem> plan = a.full ? FullPlan() : ShortPlan();
  if (!a.meshes.empty()) {
    plan.clear();
    for (const std::string& mesh : a.meshes) plan.push_back({mesh, a.work, a.placement});
  }
  Table table;
  table.PrintHeader();
  for (const PlanItem& item : plan) {
    if (item.mesh.find(':') == std::string::npos && !std::filesystem::exists(item.mesh) &&
        !std::filesystem::exists(std::filesystem::path(a.folder) / item.mesh)) {
      fmt::print("{}: not there, left out\n", item.mesh);
      continue;
    }
    RunMesh(item.mesh, MakeMesh(item.mesh, a.folder), item.work, item.placement, a.options, table);
  }
  table.PrintSummary();
  if (a.floor) PrintFloor();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Signed distance: Glint beside OpenVDB, Embree and CGAL");
  Arguments arguments;
  Declare(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    const ThreadLimit limit(arguments.threads);
    if (!arguments.growth.empty()) {
      PlotGrowth(arguments.growth);
    } else if (!arguments.pictures.empty()) {
      WritePictures(arguments.pictures);
    } else {
      RunPlan(arguments);
    }
  } catch (const InputError& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 2;
  }
  return 0;
}
