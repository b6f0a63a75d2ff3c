// Reads little-endian records from a file that may be cut or lie about its counts. Internal to colmap/.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace glint::internal {

static_assert(std::endian::native == std::endian::little, "COLMAP's binary files are little-endian");

// Buffers 1 MiB; memory does not grow with the file. Every failure throws InputError with file and current record.
class BinaryReader {
 public:
  explicit BinaryReader(const std::filesystem::path& file);
  ~BinaryReader();
  BinaryReader(const BinaryReader&) = delete;
  BinaryReader& operator=(const BinaryReader&) = delete;

  // Names the record being read in messages: "KIND NUMBER of TOTAL", NUMBER counted from 1.
  void BeginRecord(std::string_view kind, uint64_t number, uint64_t total);
  // Adds to the record's name what has been learnt of it. Cleared by BeginRecord.
  void DescribeId(uint64_t id) { id_ = id, has_id_ = true; }
  void DescribeName(std::string_view name) { name_ = name; }
  std::string Record() const;

  template <class T>
  T Read(std::string_view what) {
    static_assert(std::is_arithmetic_v<T>);
    T value;
    if (sizeof(T) <= end_ - position_) {
      std::memcpy(&value, buffer_.data() + position_, sizeof(T));
      position_ += sizeof(T);
    } else {
      ReadBytes(&value, sizeof(T), what);
    }
    return value;
  }
  void ReadBytes(void* destination, uint64_t num_bytes, std::string_view what);
  void Skip(uint64_t num_bytes, std::string_view what);
  std::string ReadZeroTerminated(std::string_view what, size_t max_length);

  // A count of `what` of which each takes at least `min_bytes_each`: checked against what is left of the file, so
  // that nothing is ever allocated for records that cannot be there.
  uint64_t ReadCount(std::string_view what, uint64_t min_bytes_each);

  uint64_t Remaining() const { return file_size_ - file_position_ + (end_ - position_); }
  [[noreturn]] void Fail(std::string_view what) const;
  const std::filesystem::path& path() const { return path_; }

 private:
  void Require(uint64_t num_bytes, std::string_view what) const;
  void Refill();

  std::filesystem::path path_;
  int file_ = -1;
  uint64_t file_size_ = 0, file_position_ = 0;  // file_position_: what has been read into the buffer so far
  std::vector<char> buffer_;
  size_t position_ = 0, end_ = 0;
  std::string_view kind_;
  uint64_t number_ = 0, total_ = 0;
  uint64_t id_ = 0;
  bool has_id_ = false;
  std::string name_;
};

}  // namespace glint::internal
