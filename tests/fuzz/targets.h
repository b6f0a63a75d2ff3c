// Every reader of files as a function that libFuzzer can call, and small sound files for it to begin with. The same
// functions run in the ordinary test program over the seeds, their mutants, and the files that once broke a reader.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace glint::fuzz {

struct Target {
  std::string_view name;
  // Reads `bytes` as a user's file would be read. An InputError is a fine answer; any other way out is a fault.
  void (*run)(std::string_view bytes);
  std::vector<std::string> (*seeds)();
};

const std::vector<Target>& Targets();
// Null if there is none of that name.
const Target* FindTarget(std::string_view name);

// The groups that Targets() is made of.
std::vector<Target> ColmapTargets();
std::vector<Target> MeshTargets();
std::vector<Target> ImageTargets();
std::vector<Target> TextTargets();

}  // namespace glint::fuzz
