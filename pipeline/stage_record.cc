#include "pipeline/stage_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "core/atomic_file.h"

namespace glint {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StageRecord, ingredients, left, seconds, notes, warnings, summary)

namespace {

using Json = nlohmann::json;
constexpr size_t kMaxChangesNamed = 3;

std::string DescribeChange(std::string_view name, const std::string* before, const std::string* now) {
  constexpr std::string_view kOption = "option ", kFile = "file ", kSummary = "summary of ";
  if (name.starts_with(kOption))
    return fmt::format("{} was {}, is {}", name.substr(kOption.size()), before ? *before : "not there",
                       now ? *now : "not there");
  if (name.starts_with(kFile)) return fmt::format("{} has changed", name.substr(kFile.size()));
  if (name.starts_with(kSummary)) return fmt::format("{} reports something else", name.substr(kSummary.size()));
  if (name == "program") return "this is another build of glint";
  return fmt::format("other {}", name);
}

}  // namespace

void WriteStageRecord(const std::filesystem::path& path, const StageRecord& record) {
  WriteFileAtomically(path, Json(record).dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::optional<StageRecord> ReadStageRecord(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::nullopt;
  try {
    return Json::parse(in).get<StageRecord>();
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

std::string DescribeChanges(const Ingredients& before, const Ingredients& now) {
  std::set<std::string> names;
  for (const auto& [name, value] : before) names.insert(name);
  for (const auto& [name, value] : now) names.insert(name);
  std::vector<std::string> changes;
  for (const std::string& name : names) {
    const auto b = before.find(name), n = now.find(name);
    if (b != before.end() && n != now.end() && b->second == n->second) continue;
    changes.push_back(
        DescribeChange(name, b == before.end() ? nullptr : &b->second, n == now.end() ? nullptr : &n->second));
  }
  if (changes.size() > kMaxChangesNamed) {
    const size_t more = changes.size() - kMaxChangesNamed;
    changes.resize(kMaxChangesNamed);
    changes.push_back(fmt::format("{} more", more));
  }
  return fmt::format("{}", fmt::join(changes, "; "));
}

}  // namespace glint
