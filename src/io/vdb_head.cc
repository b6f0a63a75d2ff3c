#include "io/vdb_head.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.h"

namespace glint::internal {
namespace {

// OpenVDB's typed metadata reads as many bytes as its type has, whatever the file says before it.
constexpr std::array<std::pair<std::string_view, uint32_t>, 13> kSizes = {{{"bool", 1},
                                                                           {"float", 4},
                                                                           {"double", 8},
                                                                           {"int32", 4},
                                                                           {"int64", 8},
                                                                           {"vec2i", 8},
                                                                           {"vec2s", 8},
                                                                           {"vec2d", 16},
                                                                           {"vec3i", 12},
                                                                           {"vec3s", 12},
                                                                           {"vec3d", 24},
                                                                           {"mat4s", 64},
                                                                           {"mat4d", 128}}};

class HeadReader {
 public:
  explicit HeadReader(const std::filesystem::path& path)
      : path_(path), in_(path, std::ios::binary), size_(static_cast<int64_t>(std::filesystem::file_size(path))) {
    if (!in_) throw InputError(path.string(), "", "cannot be read");
  }

  void Check() {
    if (size_ < 8 || Read<int64_t>() != openvdb::OPENVDB_MAGIC) Fail("expected an OpenVDB file");
    const auto version = Read<uint32_t>();
    // The file versions since OpenVDB 2 (2013); what is older is laid out differently.
    if (version < openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION)
      Fail(fmt::format("expected an OpenVDB file of version {} or later, found version {}",
                       int{openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION}, version));
    Skip(2 * sizeof(uint32_t));  // the library's version
    if (Read<char>() == 0) Fail("expected an OpenVDB file with a directory of its grids, found a stream");
    Skip(kUuidLength);
    CheckMetadata();
    const auto num_grids = Read<int32_t>();
    if (num_grids < 0) Fail(fmt::format("expected a number of grids, found {}", num_grids));
    for (int32_t i = 0; i < num_grids; ++i) CheckGrid();
  }

 private:
  static constexpr int64_t kUuidLength = 36, kMaxTextLength = 1 << 16, kBytesPerLeaf = 64;

  [[noreturn]] void Fail(std::string_view what) const { throw InputError(path_.string(), record_, what); }

  void Require(int64_t num_bytes) {
    if (num_bytes > size_ - at_) Fail(fmt::format("the file is cut at {} bytes", size_));
  }
  template <class T>
  T Read() {
    Require(sizeof(T));
    T value{};
    if (!in_.read(reinterpret_cast<char*>(&value), sizeof(T))) Fail("cannot be read");
    at_ += sizeof(T);
    return value;
  }
  void Skip(int64_t num_bytes) {
    Require(num_bytes);
    Seek(at_ + num_bytes);
  }
  void Seek(int64_t at) {
    in_.seekg(at);
    at_ = at;
  }
  std::string Text() {
    const int64_t length = Read<uint32_t>();
    if (length > kMaxTextLength) Fail(fmt::format("expected a short text, found one of {} bytes", length));
    Require(length);
    std::string text(static_cast<size_t>(length), '\0');
    if (!in_.read(text.data(), length)) Fail("cannot be read");
    at_ += length;
    return text;
  }

  void CheckMetadata() {
    const auto count = Read<int32_t>();
    if (count < 0) Fail(fmt::format("expected a number of metadata, found {}", count));
    for (int32_t i = 0; i < count; ++i) {
      const std::string name = Text(), type = Text();
      const int64_t num_bytes = Read<uint32_t>();
      Require(num_bytes);
      const auto known =
          std::find_if(kSizes.begin(), kSizes.end(), [&](const auto& size) { return size.first == type; });
      if (known != kSizes.end() && num_bytes != known->second)
        Fail(fmt::format("expected {} bytes for '{}' of type {}, found {}", known->second, name, type, num_bytes));
      const int64_t end = at_ + num_bytes;
      if (type == "__delayedload" && num_bytes > 0) {
        const int64_t num_leaves = Read<uint32_t>();
        if (num_leaves > size_ / kBytesPerLeaf)
          Fail(fmt::format("expected {} leaves that fit into the file of {} bytes", num_leaves, size_));
      }
      if (at_ > end) Fail(fmt::format("'{}' is cut", name));
      Seek(end);
    }
  }

  void CheckGrid() {
    const std::string unique_name = Text();  // equal names are told apart by what follows a control character
    record_ = fmt::format("grid '{}'", unique_name.substr(0, unique_name.find('\x1e')));
    Text();  // type
    Text();  // name of the grid whose tree it shares
    const auto grid_at = Read<int64_t>(), blocks_at = Read<int64_t>(), end = Read<int64_t>();
    if (end > size_) Fail(fmt::format("expected {} bytes, found {}: the file is cut", end, size_));
    if (grid_at < at_ || blocks_at < grid_at || end < blocks_at)
      Fail(fmt::format("expected its parts one after the other, found them at {}, {} and {}", grid_at, blocks_at, end));
    if (grid_at < end) {
      Seek(grid_at);
      Skip(sizeof(uint32_t));  // compression
      CheckMetadata();
    }
    Seek(end);
    record_.clear();
  }

  const std::filesystem::path& path_;
  std::ifstream in_;
  int64_t size_, at_ = 0;
  std::string record_;
};

}  // namespace

void CheckVdbHead(const std::filesystem::path& path) { HeadReader(path).Check(); }

}  // namespace glint::internal
