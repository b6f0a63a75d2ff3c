#include "colmap/step_record.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <system_error>

#include "core/atomic_file.h"

namespace glint {
namespace {

bool Holds(const std::filesystem::path& file, const std::string& text) {
  std::ifstream in(file, std::ios::binary);
  return in && std::string((std::istreambuf_iterator<char>(in)), {}) == text;
}

}  // namespace

StepRecord::StepRecord(const std::filesystem::path& folder, const std::string& name, std::string inputs)
    : begun_(folder / (name + ".begun")), done_(folder / (name + ".done")), inputs_(std::move(inputs)) {}

bool StepRecord::Done() const { return Holds(done_, inputs_); }
bool StepRecord::Begun() const { return Holds(begun_, inputs_); }

void StepRecord::MarkBegun() const {
  std::error_code missing;
  std::filesystem::remove(done_, missing);
  WriteFileAtomically(begun_, inputs_);
}

void StepRecord::MarkDone() const { WriteFileAtomically(done_, inputs_); }

std::string FileStamp(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  const auto time = std::filesystem::last_write_time(file, error).time_since_epoch().count();
  return fmt::format("{} {} {}\n", file.filename().string(), size, time);
}

}  // namespace glint
