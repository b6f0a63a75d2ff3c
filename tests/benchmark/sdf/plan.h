// What is measured when nothing else is asked for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/benchmark/sdf/workloads.h"

namespace glint::benchmark {

struct PlanItem {
  std::string mesh;  // as MakeMesh takes it
  std::vector<std::string> work;
  Placement placement;
};

// A few minutes; and everything, an hour.
std::vector<PlanItem> ShortPlan();
std::vector<PlanItem> FullPlan();

}  // namespace glint::benchmark
