// Which photographs are matched with which.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "colmap/photographs.h"

namespace glint {

enum class MatchingKind { kExhaustive, kSequence, kVocabulary };

struct MatchingPlan {
  MatchingKind kind = MatchingKind::kExhaustive;
  std::vector<std::pair<std::string, std::string>> pairs;  // of a sequence
};

// `matcher`: "auto" or one of "exhaustive", "sequence", "vocabulary". By itself: every pair if these are at most
// `max_pairs`; else along the sequence, if it is one, or by the vocabulary, if there is one; else every pair all the
// same.
MatchingPlan PlanMatching(const Photographs& photographs, const std::string& matcher, bool has_vocabulary,
                          size_t max_pairs);

// The pairs of a sequence: each with its neighbours, with ever farther ones, and, so that loops close, every few
// images with every few others; about `max_pairs` or fewer, but never fewer than the neighbours.
std::vector<std::pair<std::string, std::string>> SequencePairs(const std::vector<std::string>& names, size_t max_pairs);

std::string MatchingName(MatchingKind kind);

}  // namespace glint
