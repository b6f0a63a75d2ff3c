// What the parts of the refinement cost as they grow.
//   refine_speed bundle [--contacts 10,100,1000,10000,20000]   seconds of the specular bundle and how good it gets
//   refine_speed flow [--voxels 256]    a step of the flow beside OpenVDB's LevelSetFilter::meanCurvature, same grid
//   refine_speed solve [--voxels 128,256,512,1024]    the variational step: seconds and memory an active voxel
#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetFilter.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "core/median.h"
#include "refine/bundle.h"
#include "refine/flow_step.h"
#include "refine/level_set_step.h"
#include "sdf/level_set_impl.h"
#include "sdf/mesh_to_level_set.h"
#include "tests/support/ellipsoid_scene.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

template <class Work>
double Seconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double PeakMib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024;
  return 0;
}

// A film in one light: exact highlights, a surface that is 2 % too large and a little rough to start from.
void MeasureBundle(const std::vector<int>& counts) {
  fmt::print("{:>9} {:>9} {:>9} {:>10} {:>14} {:>22}\n", "contacts", "chords", "seconds", "us each", "start (% d.)",
             "median error (% d.)");
  const testing::Ellipsoid shape;
  for (const int count : counts) {
    std::vector<Light> lights = {testing::DistantLight(1, 0.2, 1)};
    testing::EllipsoidContacts scene = testing::MakeEllipsoidContacts(shape, lights, count, 200);
    std::vector<double> truth, off;
    for (size_t i = 0; i < scene.contacts.size(); ++i) {
      Contact& c = scene.contacts[i];
      truth.push_back(c.depth);
      c.prior_depth += shape.Diagonal() * (0.02 + 0.01 * std::sin(0.7 * static_cast<double>(i)));
      c.depth = c.prior_depth;
    }
    BundleSummary summary;
    const double seconds = Seconds([&] {
      summary = SolveBundle(scene.points, shape.Diagonal(), {true}, BundleOptions(), scene.contacts, lights);
    });
    for (size_t i = 0; i < truth.size(); ++i)
      off.push_back(100 * std::abs(scene.contacts[i].depth - truth[i]) / shape.Diagonal());
    fmt::print("{:>9} {:>9} {:>9.3f} {:>10.1f} {:>14.2f} {:>22.4f}\n", scene.contacts.size(), summary.num_chords,
               seconds, 1e6 * seconds / static_cast<double>(scene.contacts.size()), 2.0, Median(off));
    std::fflush(stdout);
  }
}

// A ball of unit diagonal, a little wavy.
LevelSet Ball(int voxels) {
  TriangleMesh ball = testing::Icosphere(6);
  for (Eigen::Vector3d& v : ball.vertices)
    v *= 0.5 / std::sqrt(3.0) * (1 + 0.02 * std::sin(8 * v.x()) * std::sin(7 * v.y()));
  return MeshToLevelSet(ball, 1.0 / voxels, {});
}

void MeasureFlow(int voxels) {
  constexpr int kSteps = 10, kRuns = 5;
  const LevelSet ball = Ball(voxels);
  FlowOptions options;
  options.alignment = options.points = options.force = 0;
  options.curvature = 1;
  options.max_steps = kSteps;
  std::vector<double> ours, theirs, with_contacts;
  std::vector<OrientedPoint> contacts;
  for (const Eigen::Vector3d& n : testing::Icosphere(2).vertices) {
    OrientedPoint contact;
    contact.normal = n;
    contact.position = contact.bundle_position = 0.5 / std::sqrt(3.0) * n;
    contact.sigma_normal = 0.01;
    contact.sigma_position = 0.001;
    contact.reach = 0.05;
    contacts.push_back(contact);
  }
  for (int run = 0; run < kRuns; ++run) {
    ours.push_back(Seconds([&] { FlowStep({ball, ball, Bend::kFlat, 1, {}, {}, {}}, options, nullptr); }) / kSteps);
    with_contacts.push_back(
        Seconds([&] {
          FlowStep({ball, ball, Bend::kFlat, 1, contacts, {}, {}}, FlowOptions{.max_steps = kSteps}, nullptr);
        }) /
        kSteps);
    const openvdb::FloatGrid::Ptr grid = ball.impl().grid->deepCopy();
    openvdb::tools::LevelSetFilter<openvdb::FloatGrid> filter(*grid);
    theirs.push_back(Seconds([&] {
                       for (int k = 0; k < kSteps; ++k) filter.meanCurvature();
                     }) /
                     kSteps);
  }
  fmt::print("{} active voxels, milliseconds a step (median of {} runs of {} steps)\n", ball.num_active_voxels(), kRuns,
             kSteps);
  fmt::print("  OpenVDB meanCurvature          {:.2f}\n", 1e3 * Median(theirs));
  fmt::print("  flow by curvature              {:.2f}  ({:.2f} of OpenVDB's)\n", 1e3 * Median(ours),
             Median(ours) / Median(theirs));
  fmt::print("  flow with {} contacts         {:.2f}  ({:.2f} of OpenVDB's)\n", contacts.size(),
             1e3 * Median(with_contacts), Median(with_contacts) / Median(theirs));
}

void MeasureSolve(const std::vector<int>& resolutions) {
  fmt::print("{:>9} {:>12} {:>9} {:>12} {:>11} {:>11} {:>10}\n", "diagonal", "voxels", "seconds", "us a voxel",
             "iterations", "peak (MiB)", "B a voxel");
  for (const int voxels : resolutions) {
    const LevelSet ball = Ball(voxels);
    std::vector<OrientedPoint> contacts;
    for (const Eigen::Vector3d& n : testing::Icosphere(2).vertices) {
      OrientedPoint contact;
      contact.normal = n;
      contact.position = 0.5 / std::sqrt(3.0) * n;
      contact.sigma_normal = 0.01;
      contact.reach = 0.05;
      contacts.push_back(contact);
    }
    const double before = PeakMib();
    StepSummary summary;
    const double seconds = Seconds([&] {
      VariationalStep({ball, ball, Bend::kLikeSeed, 1.05, contacts, {}, {}}, LevelSetOptions(), &summary);
    });
    const auto size = static_cast<double>(summary.num_voxels);
    fmt::print("{:>9} {:>12} {:>9.2f} {:>12.2f} {:>11} {:>11.0f} {:>10.0f}\n", voxels, summary.num_voxels, seconds,
               1e6 * seconds / size, summary.solver_iterations, PeakMib(), (PeakMib() - before) * 1048576 / size);
    std::fflush(stdout);
  }
}

int Main(int argc, char** argv) {
  openvdb::initialize();
  CLI::App app("What the parts of the refinement cost as they grow");
  app.require_subcommand(1);
  std::vector<int> contacts = {10, 100, 1000, 10000, 20000}, resolutions = {128, 256, 512, 1024};
  int voxels = 256;
  CLI::App* bundle = app.add_subcommand("bundle", "The specular bundle");
  bundle->add_option("--contacts", contacts, "numbers of contacts")->delimiter(',');
  CLI::App* flow = app.add_subcommand("flow", "A step of the flow beside OpenVDB's");
  flow->add_option("--voxels", voxels, "voxels a diagonal");
  CLI::App* solve = app.add_subcommand("solve", "The variational step");
  solve->add_option("--voxels", resolutions, "voxels a diagonal")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  if (*bundle) MeasureBundle(contacts);
  if (*flow) MeasureFlow(voxels);
  if (*solve) MeasureSolve(resolutions);
  return 0;
}

}  // namespace
}  // namespace glint

int main(int argc, char** argv) { return glint::Main(argc, argv); }
