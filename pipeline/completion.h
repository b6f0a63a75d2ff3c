// Completion of glint's command line, as scripts for the usual shells.
#pragma once

#include <string>
#include <vector>

namespace glint {

struct CompletionValue {
  enum class Kind { kNone, kFile, kChoice, kPrefix, kOther };  // kPrefix: a choice that goes on, like "voxel_rel="
  Kind kind = Kind::kNone;
  std::vector<std::string> choices;
};

struct CompletionFlag {
  std::vector<std::string> names;  // with their dashes
  std::string help;
  CompletionValue value;  // kNone: it takes none
};

struct CompletionCommand {
  std::string name;
  std::string help;
  std::vector<CompletionFlag> flags;
  CompletionValue argument;  // of the arguments without a flag
};

std::string BashCompletion(const std::vector<CompletionCommand>& commands);
std::string ZshCompletion(const std::vector<CompletionCommand>& commands);
std::string FishCompletion(const std::vector<CompletionCommand>& commands);

}  // namespace glint
