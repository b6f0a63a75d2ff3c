// The table that is printed, and what it comes to.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tests/benchmark/sdf/field_check.h"
#include "tests/benchmark/sdf/measure.h"

namespace glint::benchmark {

enum class Method { kPseudoNormal, kAuto, kOpenVdb, kExactPeer };

struct Row {
  Method method;
  std::string name;
  double items = 0;  // that it did
  Cost cost;
  std::optional<FieldErrors> errors;
};

// One piece of work on one mesh, by all methods; the first row is Glint's, by pseudo-normals.
struct Work {
  std::string mesh, name;
  size_t faces = 0, items = 0;
  bool is_band = false;
  std::vector<Row> rows;
};

class Table {
 public:
  void PrintHeader() const;
  void Add(const Work& work);
  // The least advantage over the peers, and all errors of Glint taken together.
  void PrintSummary() const;

 private:
  struct Least {
    double factor = std::numeric_limits<double>::infinity();
    std::string where;
    size_t count = 0;
    void See(double f, const std::string& w);
  };
  void Sum(const Work& work);

  Least openvdb_, exact_, exact_elsewhere_;
  FieldErrors errors_;
  std::string first_wrong_;
};

}  // namespace glint::benchmark
