#include "colmap/matching_plan.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace glint {
namespace {

constexpr size_t kNeighbours = 10;
constexpr size_t kMinLoopStep = 4;

// COLMAP reads the two names of a pair up to the first blank.
bool NamesFitPairs(const std::vector<std::string>& names) {
  return std::none_of(names.begin(), names.end(),
                      [](const std::string& name) { return name.find_first_of(" \t") != std::string::npos; });
}

}  // namespace

MatchingPlan PlanMatching(const Photographs& photographs, const std::string& matcher, bool has_vocabulary,
                          size_t max_pairs) {
  const size_t n = photographs.names.size();
  const bool can_pair = NamesFitPairs(photographs.names);
  const bool few = n * (n - (n > 0)) / 2 <= max_pairs;
  MatchingPlan plan;
  if (matcher == "vocabulary" || (matcher == "auto" && !few && has_vocabulary && !photographs.in_sequence)) {
    plan.kind = MatchingKind::kVocabulary;
  } else if (can_pair && (matcher == "sequence" || (matcher == "auto" && !few && photographs.in_sequence))) {
    plan.kind = MatchingKind::kSequence;
    plan.pairs = SequencePairs(photographs.names, max_pairs);
  }
  return plan;
}

std::vector<std::pair<std::string, std::string>> SequencePairs(const std::vector<std::string>& names,
                                                               size_t max_pairs) {
  const size_t n = names.size();
  std::set<std::pair<size_t, size_t>> pairs;
  for (size_t i = 0; i < n; ++i) {
    for (size_t d = 1; d <= kNeighbours && i + d < n; ++d) pairs.emplace(i, i + d);
    for (size_t d = 2 * kNeighbours; i + d < n; d *= 2) pairs.emplace(i, i + d);
  }
  // (n / step)² / 2 pairs in what the neighbours leave.
  const double left = static_cast<double>(max_pairs > pairs.size() ? max_pairs - pairs.size() : 0);
  if (left > 0) {
    const auto step = std::max(kMinLoopStep, static_cast<size_t>(static_cast<double>(n) / std::sqrt(2 * left)) + 1);
    for (size_t i = 0; i < n; i += step)
      for (size_t j = i + step; j < n; j += step) pairs.emplace(i, j);
  }
  std::vector<std::pair<std::string, std::string>> named;
  for (const auto& [i, j] : pairs) named.emplace_back(names[i], names[j]);
  return named;
}

std::string MatchingName(MatchingKind kind) {
  return kind == MatchingKind::kExhaustive ? "exhaustive" : kind == MatchingKind::kSequence ? "sequence" : "vocabulary";
}

}  // namespace glint
