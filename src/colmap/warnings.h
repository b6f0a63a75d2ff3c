// Collects what reading repaired: the first case of a kind in full, the others counted. Internal to colmap/.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace glint::internal {

class Warnings {
 public:
  // `describe` returns "PATH: RECORD: WHAT"; it is called for the first case of `kind` only.
  template <class Describe>
  void Add(std::string_view kind, const Describe& describe, uint64_t count = 1) {
    if (count == 0) return;
    const auto found = index_.find(kind);
    if (found != index_.end()) {
      entries_[found->second].second += count;
      return;
    }
    index_.emplace(kind, entries_.size());
    entries_.emplace_back(describe(), count);
  }

  // In the order of their first cases.
  std::vector<std::string> Take() const {
    std::vector<std::string> lines;
    for (const auto& [text, count] : entries_) {
      lines.push_back(count == 1 ? text : fmt::format("{} (and {} more of this kind)", text, count - 1));
    }
    return lines;
  }

 private:
  std::map<std::string, size_t, std::less<>> index_;
  std::vector<std::pair<std::string, uint64_t>> entries_;
};

}  // namespace glint::internal
