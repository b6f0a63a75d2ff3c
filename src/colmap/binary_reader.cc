#include "colmap/binary_reader.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "core/error.h"

namespace glint::internal {
namespace {
constexpr size_t kBufferSize = size_t{1} << 20;
}  // namespace

BinaryReader::BinaryReader(const std::filesystem::path& file) : path_(file) {
  file_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe must not wait for its writer
  if (file_ < 0) throw InputError(file.string(), "", fmt::format("cannot be opened: {}", std::strerror(errno)));
  struct stat status = {};
  if (::fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(file_);
    throw InputError(file.string(), "", "expected a file");
  }
  file_size_ = static_cast<uint64_t>(status.st_size);
  buffer_.resize(std::min<uint64_t>(kBufferSize, std::max<uint64_t>(file_size_, 1)));
}

BinaryReader::~BinaryReader() { ::close(file_); }

void BinaryReader::BeginRecord(std::string_view kind, uint64_t number, uint64_t total) {
  kind_ = kind;
  number_ = number;
  total_ = total;
  has_id_ = false;
  name_.clear();
}

std::string BinaryReader::Record() const {
  if (kind_.empty()) return "";
  std::string record = fmt::format("{} {} of {}", kind_, number_, total_);
  if (has_id_) record += fmt::format(" (id {})", id_);
  if (!name_.empty()) record += fmt::format(" '{}'", name_);
  return record;
}

void BinaryReader::Fail(std::string_view what) const { throw InputError(path_.string(), Record(), what); }

void BinaryReader::Require(uint64_t num_bytes, std::string_view what) const {
  if (num_bytes <= Remaining()) return;
  Fail(fmt::format("expected {} bytes for {}, found {}: the file is cut at {} bytes", num_bytes, what, Remaining(),
                   file_size_));
}

void BinaryReader::Refill() {
  position_ = end_ = 0;
  const size_t wanted = std::min<uint64_t>(buffer_.size(), file_size_ - file_position_);
  while (end_ < wanted) {
    const ssize_t n = ::read(file_, buffer_.data() + end_, wanted - end_);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) Fail(fmt::format("cannot be read: {}", std::strerror(errno)));
    if (n == 0) Fail("the file became shorter while it was read");
    end_ += static_cast<size_t>(n);
  }
  file_position_ += end_;
}

void BinaryReader::ReadBytes(void* destination, uint64_t num_bytes, std::string_view what) {
  Require(num_bytes, what);
  char* out = static_cast<char*>(destination);
  while (num_bytes > 0) {
    if (position_ == end_) Refill();
    const size_t n = std::min<uint64_t>(num_bytes, end_ - position_);
    std::memcpy(out, buffer_.data() + position_, n);
    position_ += n;
    out += n;
    num_bytes -= n;
  }
}

void BinaryReader::Skip(uint64_t num_bytes, std::string_view what) {
  Require(num_bytes, what);
  const size_t buffered = std::min<uint64_t>(num_bytes, end_ - position_);
  position_ += buffered;
  num_bytes -= buffered;
  if (num_bytes == 0) return;
  file_position_ += num_bytes;
  if (::lseek(file_, static_cast<off_t>(file_position_), SEEK_SET) < 0) {
    Fail(fmt::format("cannot be read: {}", std::strerror(errno)));
  }
}

std::string BinaryReader::ReadZeroTerminated(std::string_view what, size_t max_length) {
  std::string text;
  while (true) {
    if (Remaining() == 0) Fail(fmt::format("expected the end of {}, found the end of the file", what));
    const char c = Read<char>(what);
    if (c == '\0') return text;
    if (text.size() == max_length) Fail(fmt::format("expected {} of at most {} bytes", what, max_length));
    text.push_back(c);
  }
}

uint64_t BinaryReader::ReadCount(std::string_view what, uint64_t min_bytes_each) {
  const uint64_t count = Read<uint64_t>(what);
  if (count > Remaining() / min_bytes_each) {
    Fail(
        fmt::format("expected {} {} of at least {} bytes each, found {} bytes: the file is cut at {} bytes, or damaged",
                    count, what, min_bytes_each, Remaining(), file_size_));
  }
  return count;
}

}  // namespace glint::internal
