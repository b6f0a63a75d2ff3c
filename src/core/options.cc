#include "core/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace glint::internal {
namespace {

std::string Range(const OptionInfo& info) {
  const bool has_min = std::isfinite(info.min), has_max = std::isfinite(info.max);
  if (has_min && has_max) return fmt::format("must lie in [{:g}, {:g}]", info.min, info.max);
  if (has_min) return fmt::format("must be at least {:g}", info.min);
  if (has_max) return fmt::format("must be at most {:g}", info.max);
  return "must be a finite number";
}

bool InRange(const OptionInfo& info, double value) {
  return std::isfinite(value) && value >= info.min && value <= info.max;
}

}  // namespace

void ViolationVisitor::Begin(std::string_view section, std::string_view) { sections_.emplace_back(section); }
void ViolationVisitor::End() { sections_.pop_back(); }

std::string ViolationVisitor::Path(std::string_view name) const {
  std::string path;
  for (const std::string& section : sections_) path += section + ".";
  return path + std::string(name);
}

void ViolationVisitor::Field(const OptionInfo& info, double& value) {
  if (!InRange(info, value)) violations_.push_back(fmt::format("{} = {:g}: {}", Path(info.name), value, Range(info)));
}

void ViolationVisitor::Field(const OptionInfo& info, int& value) {
  if (!InRange(info, value)) violations_.push_back(fmt::format("{} = {}: {}", Path(info.name), value, Range(info)));
}

void ViolationVisitor::Field(const OptionInfo&, bool&) {}

void ViolationVisitor::Field(const OptionInfo& info, std::string& value) {
  if (info.choices.empty() || std::count(info.choices.begin(), info.choices.end(), value) > 0) return;
  violations_.push_back(
      fmt::format("{} = {}: must be one of {}", Path(info.name), value, fmt::join(info.choices, ", ")));
}

void ViolationVisitor::Field(const OptionInfo& info, std::vector<double>& value) {
  for (double v : value)
    if (!InRange(info, v)) violations_.push_back(fmt::format("{} = {:g}: {}", Path(info.name), v, Range(info)));
}

}  // namespace glint::internal
