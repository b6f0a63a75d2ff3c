// Many scenes in one table.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "tests/benchmark/scenes/case.h"
#include "tests/benchmark/scenes/measures.h"

namespace glint::benchmark {

struct Outcome {
  Measured start, result;
  std::optional<Measured> without;  // highlights
  ContactErrors contacts;
  Honesty honesty;  // where highlights pass
};

// A row for each number of views and of lights, given or unknown: over its scenes the median and the worst, where
// highlights pass (but "elsewhere"), of the contacts' median depth errors, mean normals and distances; of the mean
// normals against those without highlights; of how much the distance elsewhere got worse than the start's; of the
// shares within two standard deviations.
class Summary {
 public:
  void Add(const Case& c, bool unknown, const Outcome& outcome) {
    rows_[KeyOf(c, unknown)].push_back({c.name, outcome});
  }
  void AddFailure(const Case& c, bool unknown) { failed_[KeyOf(c, unknown)].push_back(c.name); }
  // Nothing if there is no synthetic scene.
  void Print() const;

 private:
  using Key = std::tuple<int, int, bool>;  // views, lights, unknown
  struct Entry {
    std::string name;
    Outcome outcome;
  };
  static Key KeyOf(const Case& c, bool unknown) { return {c.num_views, c.num_lights, unknown}; }

  std::map<Key, std::vector<Entry>> rows_;
  std::map<Key, std::vector<std::string>> failed_;
};

}  // namespace glint::benchmark
