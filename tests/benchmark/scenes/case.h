// A scene with its truth, and how it is run.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/triangle_mesh.h"
#include "synthetic/synthesize.h"
#include "tests/benchmark/scenes/measures.h"

namespace glint::benchmark {

// How every case is run.
struct Plan {
  std::filesystem::path out = "build/measured";
  bool unknown = false;
  bool without = true;  // also with the highlights switched off
  bool baselines = false;
  std::string from;             // empty: the first stage that is not done yet
  double normal_maps_deg = -1;  // with normal maps of the truth that are so far off; negative: without
  std::vector<std::string> settings;
};

struct Case {
  std::string name;
  int num_views = 0, num_lights = 0;  // 0: not a synthetic scene
  std::filesystem::path project, lights, normals, out;
  std::filesystem::path mesh = {};  // empty: the seed is made of the points
  TriangleMesh truth;
  Regions regions;
  Eigen::Affine3d truth_from_project = Eigen::Affine3d::Identity();
};

// Writes the project if it is not there yet.
Case SyntheticCase(const SyntheticOptions& options, const Plan& plan);

// Where highlights pass: nhl > 0; elsewhere: the rest of what at least one camera sees.
Case VaseCase(const std::filesystem::path& vase, const Plan& plan);

// `settings` beyond the plan's. Returns seconds, of all stages.
double RunCase(const Case& c, const Plan& plan, const std::vector<std::string>& settings,
               const std::filesystem::path& out);

// Of a file in the project's frame.
Measured MeasureFile(const Case& c, const std::filesystem::path& mesh);
Measured MeasureMesh(const Case& c, TriangleMesh mesh);

}  // namespace glint::benchmark
