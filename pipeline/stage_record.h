// What is remembered of a stage that was done: what went into it, what it left, and what it had to say.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace glint {

// What decides a stage's result, by name: "program", "images", "option refine.voxel_rel", "file stages/start.ply", ...
// Files by their hash, options by their value.
using Ingredients = std::map<std::string, std::string>;

struct StageRecord {
  Ingredients ingredients;
  std::map<std::string, std::string> left;  // files by their path in the workspace, and their hashes; empty: no file
  double seconds = 0;
  std::vector<std::string> notes;
  std::vector<std::string> warnings;
  std::string summary;  // pipeline/summary_json.h
};

// Atomic. Throws InputError if it cannot be written.
void WriteStageRecord(const std::filesystem::path& path, const StageRecord& record);

// Nothing where there is no record or an unsound one: the stage is then as good as never done.
std::optional<StageRecord> ReadStageRecord(const std::filesystem::path& path);

// The first differences in words ("refine.voxel_rel was 0.01, is 0.02; the images have changed"); empty: none.
std::string DescribeChanges(const Ingredients& before, const Ingredients& now);

}  // namespace glint
