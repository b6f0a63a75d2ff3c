#include "tests/benchmark/scenes/summary.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace glint::benchmark {
namespace {

// "median (worst name)", of `value` of the entries.
template <class Entries, class Value>
std::string MedianAndWorst(const Entries& entries, bool most_is_worst, int digits, const Value& value) {
  std::vector<std::pair<double, std::string>> values;
  for (const auto& entry : entries) values.emplace_back(value(entry.outcome), entry.name);
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  const double median = 0.5 * (values[(n - 1) / 2].first + values[n / 2].first);
  const auto& worst = most_is_worst ? values.back() : values.front();
  return fmt::format("{:.{}f} ({:.{}f} {})", median, digits, worst.first, digits,
                     worst.second.substr(0, worst.second.find(' ')));
}

}  // namespace

void Summary::Print() const {
  std::map<Key, std::vector<Entry>> rows = rows_;
  for (const auto& [key, names] : failed_) rows[key];
  fmt::print("\n{:>5} {:>6} {:<8} {:>6} {:>20} {:>20} {:>20} {:>20} {:>22} {:>20} {:>20}\n", "views", "lights", "are",
             "scenes", "contacts (% diag)", "normals (deg)", "distance (% diag)", "against without",
             "elsewhere, % worse", "2 sigma: place (%)", "normal (%)");
  for (const auto& [key, entries] : rows) {
    const auto& [views, lights, unknown] = key;
    if (views == 0) continue;
    const auto failed = failed_.find(key);
    const std::string without_result =
        failed == failed_.end() ? "" : fmt::format("no result: {}", fmt::join(failed->second, ", "));
    fmt::print("{:>5} {:>6} {:<8} {:>6}", views, lights, unknown ? "unknown" : "given", entries.size());
    if (!entries.empty()) {
      const bool compared =
          std::all_of(entries.begin(), entries.end(), [](const Entry& e) { return !!e.outcome.without; });
      fmt::print(" {:>20} {:>20} {:>20} {:>20} {:>22} {:>20} {:>20}",
                 MedianAndWorst(entries, true, 3, [](const Outcome& o) { return 100 * o.contacts.depth_rel.median; }),
                 MedianAndWorst(entries, true, 2, [](const Outcome& o) { return o.result.normal_in.mean; }),
                 MedianAndWorst(entries, true, 3, [](const Outcome& o) { return 100 * o.result.distance_in.mean; }),
                 !compared ? "-"
                           : MedianAndWorst(
                                 entries, true, 2,
                                 [](const Outcome& o) { return o.result.normal_in.mean / o.without->normal_in.mean; }),
                 MedianAndWorst(
                     entries, true, 3,
                     [](const Outcome& o) { return 100 * (o.result.distance_out.mean - o.start.distance_out.mean); }),
                 MedianAndWorst(entries, false, 0, [](const Outcome& o) { return 100 * o.honesty.position; }),
                 MedianAndWorst(entries, false, 0, [](const Outcome& o) { return 100 * o.honesty.normal; }));
    }
    fmt::print(" {}\n", without_result);
  }
}

}  // namespace glint::benchmark
