#include "pipeline/option_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "pipeline/edit_distance.h"

namespace glint {
namespace {

constexpr size_t kMaxPathLength = 200;  // no option's path is as long, and the work grows with the length

std::string_view LastPart(std::string_view path) {
  const size_t dot = path.rfind('.');
  return dot == std::string_view::npos ? path : path.substr(dot + 1);
}

template <class T>
bool ParseNumber(std::string_view text, T& value) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  T parsed{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), parsed);
  if (error != std::errc() || end != text.data() + text.size()) return false;
  if constexpr (std::is_floating_point_v<T>) {
    if (!std::isfinite(parsed)) return false;
  }
  value = parsed;
  return true;
}

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

// "[1, 2.5]" or "1, 2.5".
bool ParseList(std::string_view text, std::vector<double>& values) {
  text = Trimmed(text);
  if (text.size() >= 2 && text.front() == '[' && text.back() == ']') text = Trimmed(text.substr(1, text.size() - 2));
  std::vector<double> parsed;
  while (!text.empty()) {
    const size_t comma = text.find(',');
    if (!ParseNumber(Trimmed(text.substr(0, comma)), parsed.emplace_back())) return false;
    if (comma == std::string_view::npos) break;
    text = Trimmed(text.substr(comma + 1));
    if (text.empty()) return false;
  }
  values = std::move(parsed);
  return true;
}

// A string needs quotes unless every reader takes it for a plain word.
std::string QuotedIfNeeded(const std::string& text) {
  const bool plain =
      !text.empty() && std::isalpha(static_cast<unsigned char>(text.front())) &&
      std::all_of(text.begin(), text.end(),
                  [](char c) {
                    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '/' || c == '.';
                  }) &&
      text != "true" && text != "false" && text != "null" && text != "yes" && text != "no" && text != "on" &&
      text != "off";
  if (plain) return text;
  std::string quoted = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

}  // namespace

void OptionTable::Builder::Begin(std::string_view section, std::string_view help) {
  sections_.emplace_back(section);
  OptionItem item;
  item.kind = OptionItem::Kind::kBeginSection;
  item.path = fmt::format("{}", fmt::join(sections_, "."));
  item.name = section;
  item.help = help;
  table_.items_.push_back(std::move(item));
}

void OptionTable::Builder::End() {
  OptionItem item;
  item.kind = OptionItem::Kind::kEndSection;
  table_.items_.push_back(std::move(item));
  sections_.pop_back();
}

void OptionTable::Builder::Add(const OptionInfo& info, OptionItem::Value value) {
  OptionItem item;
  item.path = sections_.empty() ? std::string(info.name) : fmt::format("{}.{}", fmt::join(sections_, "."), info.name);
  item.name = info.name;
  item.help = info.help;
  item.unit = info.unit;
  item.min = info.min;
  item.max = info.max;
  item.choices.assign(info.choices.begin(), info.choices.end());
  item.value = value;
  table_.items_.push_back(std::move(item));
}

const OptionItem* OptionTable::Find(std::string_view path, OptionItem::Kind kind) const {
  for (const OptionItem& item : items_)
    if (item.kind == kind && item.path == path) return &item;
  return nullptr;
}

const OptionItem* OptionTable::FindField(std::string_view path) const { return Find(path, OptionItem::Kind::kField); }

const OptionItem* OptionTable::FindSection(std::string_view path) const {
  return Find(path, OptionItem::Kind::kBeginSection);
}

std::string OptionTable::Nearest(std::string_view path) const {
  path = path.substr(0, kMaxPathLength);
  const OptionItem* best = nullptr;
  size_t best_cost = std::numeric_limits<size_t>::max();
  for (const OptionItem& item : items_) {
    if (item.kind == OptionItem::Kind::kEndSection) continue;
    // The right name in the wrong section is as likely a slip as a misspelt name: one edit more than the name's own.
    const size_t cost = std::min(EditDistance(path, item.path), EditDistance(LastPart(path), item.name) + 1);
    if (cost < best_cost) {
      best_cost = cost;
      best = &item;
    }
  }
  return best ? best->path : "";
}

std::string ExpectedValue(const OptionItem& item) {
  if (!item.choices.empty()) return fmt::format("one of {}", fmt::join(item.choices, ", "));
  switch (item.value.index()) {
    case 0:
      return "a number";
    case 1:
      return "a whole number";
    case 2:
      return "true or false";
    case 3:
      return "a text";
    default:
      return "a list of numbers like [1, 2]";
  }
}

std::string FormatValue(const OptionItem& item) {
  if (const auto* number = std::get_if<double*>(&item.value)) return fmt::format("{}", **number);
  if (const auto* whole = std::get_if<int*>(&item.value)) return fmt::format("{}", **whole);
  if (const auto* flag = std::get_if<bool*>(&item.value)) return **flag ? "true" : "false";
  if (const auto* text = std::get_if<std::string*>(&item.value)) return QuotedIfNeeded(**text);
  return fmt::format("[{}]", fmt::join(*std::get<std::vector<double>*>(item.value), ", "));
}

bool ParseValue(const OptionItem& item, std::string_view text) {
  if (const auto* number = std::get_if<double*>(&item.value)) return ParseNumber(Trimmed(text), **number);
  if (const auto* whole = std::get_if<int*>(&item.value)) return ParseNumber(Trimmed(text), **whole);
  if (const auto* flag = std::get_if<bool*>(&item.value)) {
    text = Trimmed(text);
    if (text != "true" && text != "false") return false;
    **flag = text == "true";
    return true;
  }
  if (const auto* string = std::get_if<std::string*>(&item.value)) {
    **string = text;
    return true;
  }
  return ParseList(text, *std::get<std::vector<double>*>(item.value));
}

std::string DescribeConstraint(const OptionItem& item) {
  std::string range;
  const bool has_min = std::isfinite(item.min), has_max = std::isfinite(item.max);
  if (!item.choices.empty()) {
    range = fmt::format("one of {}", fmt::join(item.choices, ", "));
  } else if (has_min && has_max) {
    range = fmt::format("{:g} to {:g}", item.min, item.max);
  } else if (has_min) {
    range = fmt::format("at least {:g}", item.min);
  } else if (has_max) {
    range = fmt::format("at most {:g}", item.max);
  }
  if (item.unit.empty()) return range;
  return range.empty() ? item.unit : fmt::format("{}, {}", range, item.unit);
}

}  // namespace glint
