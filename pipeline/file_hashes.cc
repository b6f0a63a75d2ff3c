#include "pipeline/file_hashes.h"

#include <elf.h>
#include <fmt/format.h>
#include <link.h>
#include <sys/stat.h>
#include <xxhash.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/parallel.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// A file that changes again this soon after it was read may keep its time of change: clocks tick coarsely.
constexpr int64_t kTickNs = 2'000'000'000;
// What fits into nanoseconds since 1970, with room for a tick: a file may claim to be of any year.
constexpr int64_t kMaxSeconds = 9'000'000'000;

std::string Text(const XXH128_hash_t& hash) { return fmt::format("{:016x}{:016x}", hash.high64, hash.low64); }

std::string HashOfContents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
  XXH3_128bits_reset(state.get());
  std::vector<char> buffer(1 << 20);
  while (in && in.peek() != std::ifstream::traits_type::eof()) {
    in.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    XXH3_128bits_update(state.get(), buffer.data(), static_cast<size_t>(in.gcount()));
  }
  if (!in.is_open() || in.bad()) throw InputError(file.string(), "", "cannot be read");
  return Text(XXH3_128bits_digest(state.get()));
}

int64_t ChangedNs(const timespec& time) {
  return std::clamp<int64_t>(time.tv_sec, -kMaxSeconds, kMaxSeconds) * 1'000'000'000 + time.tv_nsec;
}

int64_t NowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

// Searches the loaded objects for the one that holds a function of ours and reads its NT_GNU_BUILD_ID note.
struct BuildIdSearch {
  uintptr_t address;
  std::string id;
};

std::string FindBuildIdNote(const char* note, size_t size) {
  while (size >= sizeof(ElfW(Nhdr))) {
    ElfW(Nhdr) header;
    std::memcpy(&header, note, sizeof header);
    const size_t name_size = (header.n_namesz + 3) & ~size_t{3}, data_size = (header.n_descsz + 3) & ~size_t{3};
    if (size < sizeof header + name_size + data_size) return "";
    const char* name = note + sizeof header;
    if (header.n_type == NT_GNU_BUILD_ID && header.n_namesz == 4 && std::memcmp(name, "GNU", 4) == 0) {
      std::string id;
      for (size_t i = 0; i < header.n_descsz; ++i)
        id += fmt::format("{:02x}", static_cast<unsigned char>(name[name_size + i]));
      return id;
    }
    note += sizeof header + name_size + data_size;
    size -= sizeof header + name_size + data_size;
  }
  return "";
}

int VisitObject(dl_phdr_info* object, size_t, void* data) {
  auto& search = *static_cast<BuildIdSearch*>(data);
  bool ours = false;
  for (int i = 0; i < object->dlpi_phnum; ++i) {
    const ElfW(Phdr)& part = object->dlpi_phdr[i];
    const uintptr_t begin = object->dlpi_addr + part.p_vaddr;
    ours |= part.p_type == PT_LOAD && search.address >= begin && search.address - begin < part.p_memsz;
  }
  for (int i = 0; ours && search.id.empty() && i < object->dlpi_phnum; ++i) {
    const ElfW(Phdr)& part = object->dlpi_phdr[i];
    if (part.p_type == PT_NOTE)
      // NOLINTNEXTLINE(performance-no-int-to-ptr): the loader tells addresses as numbers
      search.id = FindBuildIdNote(reinterpret_cast<const char*>(object->dlpi_addr + part.p_vaddr), part.p_memsz);
  }
  return ours ? 1 : 0;
}

}  // namespace

FileHashes::FileHashes(fs::path memory) : memory_(std::move(memory)) {
  std::ifstream in(memory_, std::ios::binary);
  if (!in) return;
  const Json root = Json::parse(in, nullptr, /*allow_exceptions=*/false);
  if (!root.is_object()) return;
  for (const auto& [path, e] : root.items()) {
    if (!e.is_array() || e.size() != 5 || !e[0].is_number_unsigned() || !e[1].is_number_unsigned() ||
        !e[2].is_number_integer() || !e[3].is_number_integer() || !e[4].is_string())
      continue;
    known_[path] = {e[0], e[1], e[2], e[3], e[4]};
  }
}

std::string FileHashes::Of(const fs::path& file) {
  struct stat status = {};
  if (::stat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return "";
  Entry entry;
  entry.size = static_cast<uint64_t>(status.st_size);
  entry.inode = status.st_ino;
  entry.changed_ns = ChangedNs(status.st_mtim);
  entry.read_ns = NowNs();
  const std::string key = fs::absolute(file).lexically_normal().string();
  {
    std::lock_guard lock(mutex_);
    const auto known = known_.find(key);
    if (known != known_.end() && known->second.size == entry.size && known->second.inode == entry.inode &&
        known->second.changed_ns == entry.changed_ns && entry.changed_ns + kTickNs < known->second.read_ns)
      return known->second.hash;
  }
  entry.hash = HashOfContents(file);
  std::lock_guard lock(mutex_);
  return (known_[key] = entry).hash;
}

std::string FileHashes::Of(const fs::path& folder, const std::vector<std::string>& names) {
  std::vector<std::string> hashes(names.size());
  ParallelFor(names.size(), 1, [&](size_t i) { hashes[i] = Of(folder / names[i]); });
  std::string all;
  for (size_t i = 0; i < names.size(); ++i) all += names[i] + '\0' + hashes[i] + '\0';
  return Text(XXH3_128bits(all.data(), all.size()));
}

void FileHashes::Save() const {
  Json root = Json::object();
  for (const auto& [path, e] : known_) root[path] = {e.size, e.inode, e.changed_ns, e.read_ns, e.hash};
  WriteFileAtomically(memory_, root.dump(0, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::string BuildId() {
  BuildIdSearch search{reinterpret_cast<uintptr_t>(&BuildId), ""};
  dl_iterate_phdr(&VisitObject, &search);
  return search.id;
}

}  // namespace glint
