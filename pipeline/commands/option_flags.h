// Command-line flags made from declared options: `--voxel-rel X` from the field voxel_rel, with its help, default
// and range.
#pragma once

#include <initializer_list>
#include <memory>
#include <string_view>

#include "core/error.h"
#include "core/options.h"
#include "pipeline/option_table.h"

namespace CLI {
class App;
}

namespace glint {

// Adds a flag for every field of `table` but those in `except` (paths). The options behind it must live until the
// command's action has run.
void AddOptionFlags(CLI::App& command, const OptionTable& table, std::initializer_list<std::string_view> except = {});

// Throws InputError that lists every violated range.
template <class Options>
void CheckOptions(const Options& options) {
  std::string all;
  for (const std::string& violation : Violations(options)) all += (all.empty() ? "" : "\n") + violation;
  if (!all.empty()) throw InputError("", "", all);
}

}  // namespace glint
