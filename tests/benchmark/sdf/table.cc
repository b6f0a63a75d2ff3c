#include "tests/benchmark/sdf/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "core/parallel.h"
#include "sdf/tile_kernel.h"

namespace glint::benchmark {

namespace {

constexpr const char* kRow =
    "| {:20} | {:>7} | {:14} | {:>7} | {:22} | {:>7} | {:>7} | {:>8} | {:>6} | {:>6} | {:>7} | {:>7} | {:>14} | {:>7} "
    "|\n";

std::string Compact(size_t n) {
  if (n >= 10'000'000) return fmt::format("{:.1f} M", static_cast<double>(n) / 1e6);
  if (n >= 1'000'000) return fmt::format("{:.2f} M", static_cast<double>(n) / 1e6);
  return n >= 10'000 ? fmt::format("{:.0f} k", static_cast<double>(n) / 1e3) : fmt::format("{}", n);
}

double Nanoseconds(const Row& row) { return 1e9 * row.cost.cpu_s / row.items; }

}  // namespace

void Table::Least::See(double f, const std::string& w) {
  ++count;
  if (!(f < factor)) return;
  factor = f;
  where = w;
}

void Table::PrintHeader() const {
  fmt::print(
      "Tile kernel: {}; {} threads. CPU ns an item (active voxel or point); × of Glint by pseudo-normals; MB beyond "
      "what\nwas in use before. Exact peers: trees built beforehand, distances at a part of the voxels of Glint's "
      "field, seconds\nscaled to all. Checked: voxels compared with brute force in double, the largest error as a "
      "fraction of the diagonal;\nwrong signs by exact arithmetic (closed meshes); missing: of the checked, inactive "
      "though in the band.\n\n",
      internal::TileKernelTarget(), NumThreads());
  fmt::print(kRow, "mesh", "faces", "work", "items", "method", "wall s", "CPU s", "ns/item", "×", "MB", "checked",
             "error", "wrong signs", "missing");
  fmt::print(kRow, "-", "-:", "-", "-:", "-", "-:", "-:", "-:", "-:", "-:", "-:", "-:", "-:", "-:");
  std::fflush(stdout);
}

void Table::Add(const Work& work) {
  for (const Row& row : work.rows) {
    const bool checked = row.errors && row.errors->distances > 0, sides = row.errors && row.errors->signs > 0;
    const double share = static_cast<double>(work.items) / row.items;
    fmt::print(kRow, work.mesh, Compact(work.faces), work.name, Compact(work.items), row.name,
               fmt::format("{:.3f}", row.cost.wall_s * share), fmt::format("{:.3f}", row.cost.cpu_s * share),
               fmt::format("{:.1f}", Nanoseconds(row)),
               fmt::format("{:.2f}", Nanoseconds(row) / Nanoseconds(work.rows.front())),
               row.cost.peak_bytes > 0 ? fmt::format("{:.1f}", row.cost.peak_bytes / 1e6) : "",
               checked ? Compact(row.errors->distances) : "",
               checked ? fmt::format("{:.1e}", row.errors->worst_rel) : "",
               sides ? fmt::format("{} / {}", row.errors->wrong_signs, Compact(row.errors->signs)) : "",
               checked && work.is_band ? fmt::format("{}", row.errors->missing) : "");
  }
  std::fflush(stdout);
  Sum(work);
}

void Table::Sum(const Work& work) {
  const std::string where = work.mesh + " " + work.name;
  const Row* ours = &work.rows.front();  // the field that "auto" gives, where that is another
  for (const Row& row : work.rows)
    if (row.method == Method::kAuto && row.errors) ours = &row;
  if (ours->errors) {
    errors_ = errors_ + *ours->errors;
    if (ours->errors->wrong_signs > 0 && first_wrong_.empty()) first_wrong_ = where;
  }
  double exact = std::numeric_limits<double>::infinity();
  for (const Row& row : work.rows) {
    const double factor = Nanoseconds(row) / Nanoseconds(work.rows.front());
    if (row.method == Method::kOpenVdb) openvdb_.See(factor, where);
    if (row.method == Method::kExactPeer) exact = std::min(exact, factor);
  }
  if (exact < std::numeric_limits<double>::infinity()) (work.is_band ? exact_ : exact_elsewhere_).See(exact, where);
}

void Table::PrintSummary() const {
  fmt::print(
      "\nGlint (auto) in all: {} voxels and points checked by brute force, largest error {:.1e} of the diagonal, "
      "{} missing;\n{} signs checked, {} wrong{}\n",
      errors_.distances, errors_.worst_rel, errors_.missing, errors_.signs, errors_.wrong_signs,
      first_wrong_.empty() ? "" : ", first of " + first_wrong_);
  const auto print = [](const char* what, const Least& least) {
    if (least.count > 0)
      fmt::print("CPU time, {}: at least {:.1f} times faster, of {} ({})\n", what, least.factor, least.count,
                 least.where);
  };
  print("bands, than OpenVDB", openvdb_);
  print("bands, than the best exact peer", exact_);
  print("dense grids and points, than the best exact peer", exact_elsewhere_);
  std::fflush(stdout);
}

}  // namespace glint::benchmark
