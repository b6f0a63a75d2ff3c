// What has been done in a folder, so that it is not done again: a step is told by its name and by all that its result
// depends on.
#pragma once

#include <filesystem>
#include <string>

namespace glint {

class StepRecord {
 public:
  // `inputs`: any text; another text is another step.
  StepRecord(const std::filesystem::path& folder, const std::string& name, std::string inputs);

  bool Done() const;   // finished with these inputs
  bool Begun() const;  // begun with these inputs, and not with others since
  void MarkBegun() const;
  void MarkDone() const;

 private:
  std::filesystem::path begun_, done_;
  std::string inputs_;
};

// Name, size and time of change of a file, for the inputs of a step.
std::string FileStamp(const std::filesystem::path& file);

}  // namespace glint
