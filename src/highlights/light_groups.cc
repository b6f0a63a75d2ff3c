#include "highlights/light_groups.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/check.h"

namespace glint {
namespace {

constexpr int kMaxGroups = 4;
constexpr int kRounds = 20;
constexpr int kMinViews = 3;             // of a group
constexpr double kOn = 0.5, kOff = 0.2;  // share of the views that should show a light and do

class Grouping {
 public:
  Grouping(const std::vector<LightShows>& lights, size_t num_views) : lights_(lights), num_views_(num_views) {}

  // Probability that each light shows in a view of the group that should show it; counts start at one half.
  std::vector<std::vector<double>> Shares(const std::vector<int>& labels, int count) const {
    std::vector<std::vector<double>> shares(count, std::vector<double>(lights_.size()));
    for (int g = 0; g < count; ++g)
      for (size_t k = 0; k < lights_.size(); ++k) {
        double expected = 1, present = 0.5;
        for (size_t v = 0; v < num_views_; ++v)
          if (labels[v] == g && lights_[k].expected[v]) expected += 1, present += lights_[k].present[v] ? 1 : 0;
        shares[g][k] = present / expected;
      }
    return shares;
  }

  double Cost(size_t view, const std::vector<double>& shares) const {
    double cost = 0;
    for (size_t k = 0; k < lights_.size(); ++k)
      if (lights_[k].expected[view]) cost -= 2 * std::log(lights_[k].present[view] ? shares[k] : 1 - shares[k]);
    return cost;
  }

  // The cheapest labels for these shares (Viterbi).
  std::vector<int> Label(const std::vector<std::vector<double>>& shares) const {
    const int count = static_cast<int>(shares.size());
    std::vector<std::vector<int>> from(num_views_, std::vector<int>(count));
    std::vector<double> total(count, 0);
    for (size_t v = 0; v < num_views_; ++v) {
      const int cheapest = static_cast<int>(std::min_element(total.begin(), total.end()) - total.begin());
      std::vector<double> next(count);
      for (int g = 0; g < count; ++g) {
        const bool change = v > 0 && total[cheapest] + ChangeCost(count) < total[g];
        from[v][g] = change ? cheapest : g;
        next[g] = (change ? total[cheapest] + ChangeCost(count) : total[g]) + Cost(v, shares[g]);
      }
      total = next;
    }
    std::vector<int> labels(num_views_);
    int g = static_cast<int>(std::min_element(total.begin(), total.end()) - total.begin());
    for (size_t v = num_views_; v-- > 0;) {
      labels[v] = g;
      g = from[v][g];
    }
    return labels;
  }

  double Length(const std::vector<int>& labels, int count) const {
    const auto shares = Shares(labels, count);
    double length = count * static_cast<double>(lights_.size()) * std::log(static_cast<double>(num_views_));
    for (size_t v = 0; v < num_views_; ++v) {
      length += Cost(v, shares[labels[v]]);
      if (v > 0 && labels[v] != labels[v - 1]) length += ChangeCost(count);
    }
    return length;
  }

  // Every group is large enough, and each two of them have a light of their own.
  bool Sound(const std::vector<int>& labels, int count) const {
    const auto shares = Shares(labels, count);
    for (int a = 0; a < count; ++a) {
      if (std::count(labels.begin(), labels.end(), a) < kMinViews) return false;
      for (int b = 0; b < count; ++b) {
        bool own = a == b;
        for (size_t k = 0; k < lights_.size(); ++k) own |= shares[a][k] > kOn && shares[b][k] < kOff;
        if (!own) return false;
      }
    }
    return true;
  }

 private:
  // When, and to what.
  double ChangeCost(int count) const {
    return 2 * std::log(static_cast<double>(num_views_)) + 2 * std::log(std::max(1.0, count - 1.0));
  }

  const std::vector<LightShows>& lights_;
  size_t num_views_;
};

LightGroups GroupInOrder(const std::vector<LightShows>& lights, size_t n) {
  const Grouping grouping(lights, n);
  LightGroups best;
  best.group_of_view.assign(n, 0);
  double shortest = n > 0 ? grouping.Length(best.group_of_view, 1) : 0;
  for (int count = 2; count <= kMaxGroups && n >= static_cast<size_t>(count) * kMinViews; ++count) {
    // Groups are first told apart by which of `count` lights a view shows.
    std::vector<size_t> chosen(count);
    for (int g = 0; g < count; ++g) chosen[g] = g;
    while (lights.size() >= static_cast<size_t>(count)) {
      std::vector<std::vector<double>> shares(count, std::vector<double>(lights.size(), 0.5));
      for (int g = 0; g < count; ++g)
        for (int other = 0; other < count; ++other) shares[g][chosen[other]] = g == other ? 0.9 : 0.05;
      std::vector<int> labels;
      for (int round = 0; round < kRounds; ++round) {
        std::vector<int> next = grouping.Label(shares);
        if (next == labels) break;
        labels = std::move(next);
        shares = grouping.Shares(labels, count);
      }
      const double length = grouping.Length(labels, count);
      if (length < shortest && grouping.Sound(labels, count)) {
        shortest = length;
        best.count = count;
        best.group_of_view = labels;
      }
      // The next set of lights, in lexicographic order.
      int last = count - 1;
      while (last >= 0 && chosen[last] == lights.size() - count + last) --last;
      if (last < 0) break;
      ++chosen[last];
      for (int g = last + 1; g < count; ++g) chosen[g] = chosen[g - 1] + 1;
    }
  }
  for (const auto& shares : grouping.Shares(best.group_of_view, best.count)) {
    std::vector<char> on;
    for (double share : shares) on.push_back(best.count == 1 || share > kOff);
    best.shines.push_back(on);
  }
  return best;
}

// Digits count by the number that they make.
bool Before(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const auto number = [&](const std::string& s, size_t& k) {
      while (k + 1 < s.size() && s[k] == '0' && digit(s[k + 1])) ++k;
      const size_t first = k;
      while (k < s.size() && digit(s[k])) ++k;
      return s.substr(first, k - first);
    };
    const std::string x = number(a, i), y = number(b, j);
    if (x != y) return x.size() != y.size() ? x.size() < y.size() : x < y;
  }
  return a.size() - i < b.size() - j;
}

}  // namespace

std::vector<size_t> OrderByNumbers(const std::vector<std::string>& names) {
  std::vector<size_t> order(names.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return Before(names[a], names[b]); });
  return order;
}

LightGroups GroupViewsByLight(const std::vector<LightShows>& lights, const std::vector<size_t>& order) {
  const size_t n = order.size();
  std::vector<LightShows> in_order(lights.size());
  for (size_t k = 0; k < lights.size(); ++k) {
    GLINT_CHECK(lights[k].expected.size() == n && lights[k].present.size() == n);
    for (size_t v : order) {
      in_order[k].expected.push_back(lights[k].expected[v]);
      in_order[k].present.push_back(lights[k].present[v]);
    }
  }
  LightGroups groups = GroupInOrder(in_order, n);
  std::vector<int> by_view(n);
  for (size_t i = 0; i < n; ++i) by_view[order[i]] = groups.group_of_view[i];
  groups.group_of_view = by_view;
  return groups;
}

std::vector<std::string> DescribeGroups(const LightGroups& groups, const std::vector<std::string>& names) {
  const std::vector<size_t> order = OrderByNumbers(names);
  std::vector<std::string> runs;
  for (int g = 0; g < groups.count; ++g) {
    std::string text;
    const auto in_group = [&](size_t i) { return i < order.size() && groups.group_of_view[order[i]] == g; };
    for (size_t i = 0; i < order.size(); ++i) {
      if (!in_group(i)) continue;
      const bool first = i == 0 || !in_group(i - 1), last = !in_group(i + 1);
      if (first) text += (text.empty() ? "" : ", ") + names[order[i]];
      if (last && !first) text += " to " + names[order[i]];
    }
    runs.push_back(text);
  }
  return runs;
}

}  // namespace glint
