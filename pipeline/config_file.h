// Configuration files: YAML over any table of options.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "pipeline/option_table.h"

namespace glint {

// Where values came from and what was wrong with them, gathered so that a user sees everything at once.
struct ConfigProblems {
  std::map<std::string, std::string> origin;  // option path -> "FILE:LINE" or "--set"
  std::vector<std::string> messages;          // "FILE:LINE: PATH: WHAT"

  // Throws InputError with every message, one a line, if there are any.
  void ThrowIfAny() const;
};

// Sets the fields named in a YAML file. Unknown keys, wrong types and keys given twice become messages with file,
// line and the nearest valid key; they leave the field as it was. Throws InputError when the file cannot be read
// or is not YAML at all.
void ReadYamlFile(const std::filesystem::path& file, const OptionTable& table, ConfigProblems& problems);

// Sets one field from "path=value" as given to --set.
void ApplySetting(const std::string& setting, const OptionTable& table, ConfigProblems& problems);

// The options as a commented YAML text under `title`, in the order of their declaration; reads back to equal values.
std::string WriteYaml(const OptionTable& table, const std::string& title);

}  // namespace glint
