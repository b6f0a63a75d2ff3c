#include "tests/benchmark/sdf/plan.h"

namespace glint::benchmark {

std::vector<PlanItem> ShortPlan() {
  return {
      {"spot.obj", {"band:256:3", "band:512:3", "band:1024:3", "band:256:10", "points:200000", "dense:128"}, {}},
      {"spiky:20000", {"band:256:3", "band:256:10", "dense:128"}, {}},
      {"scan:300000", {"band:512:3"}, {}},
      {"smooth:1000000", {"band:512:3"}, {}},
      {"thingi/472042.stl", {"band:512:3"}, {}},
      {"armadillo.obj", {"band:512:3", "dense:128"}, {}},
      {"spot.obj", {"band:64:3", "points:20000"}, {1e-3, 0}},
      {"spiky:20000", {"band:256:3", "dense:64"}, {1, 1e6}},
      {"spot.obj", {"band:256:3", "points:20000"}, {1e6, 1}},
  };
}

std::vector<PlanItem> FullPlan() {
  const std::vector<std::string> bands = {"band:256:3", "band:512:3", "band:1024:3", "band:256:10", "band:512:10"};
  std::vector<std::string> all = bands;
  all.insert(all.end(), {"points:1000000", "dense:128", "dense:256"});
  std::vector<PlanItem> plan;
  for (const char* mesh : {"spot.obj", "fertility.off", "nefertiti.obj", "armadillo.obj", "smooth:10000",
                           "smooth:100000", "smooth:1000000", "scan:300000", "spiky:20000", "spiky:200000"})
    plan.push_back({mesh, all, {}});
  for (const char* mesh : {"thingi/112932.stl", "thingi/472042.stl", "thingi/520644.stl", "thingi/58011.stl",
                           "thingi/79741.stl", "thingi/88566.stl"})
    plan.push_back({mesh, {"band:256:3", "band:512:3", "band:256:10", "dense:128"}, {}});
  plan.push_back({"smooth:3000000", {"band:512:3", "band:1024:3"}, {}});
  for (const Placement& at : {Placement{1e-3, 0}, Placement{1e6, 0}, Placement{1, 1e-3}, Placement{1, 1},
                              Placement{1, 1e6}, Placement{1e-3, 1e6}})
    for (const char* mesh : {"spot.obj", "spiky:20000"})
      plan.push_back({mesh, {"band:64:3", "band:64:10", "dense:128"}, at});
  return plan;
}

}  // namespace glint::benchmark
