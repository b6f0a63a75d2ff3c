#include "core/available_memory.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace glint {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kUnlimited = std::numeric_limits<uint64_t>::max();

// First number in a file of /proc or /sys after `key`; kUnlimited if there is none ("max", or no such file).
uint64_t NumberIn(const fs::path& file, const std::string& key = "") {
  std::ifstream in(file);
  std::string word;
  while (in >> word) {
    if (!key.empty() && word != key) continue;
    if (!key.empty() && !(in >> word)) break;
    if (word.find_first_not_of("0123456789") != std::string::npos || word.size() > 18) return kUnlimited;
    return std::stoull(word);
  }
  return kUnlimited;
}

uint64_t Difference(uint64_t limit, uint64_t used) {
  if (limit == kUnlimited || used == kUnlimited) return kUnlimited;
  return limit > used ? limit - used : 0;
}

// The names of a control group's files.
struct GroupFiles {
  const char *limit, *used, *cache;
};
constexpr GroupFiles kVersion1 = {"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"};
constexpr GroupFiles kVersion2 = {"memory.max", "memory.current", "inactive_file"};

// Files that were read and are not in use count as used but are given up on demand.
uint64_t LeftIn(const fs::path& group, const GroupFiles& files) {
  const uint64_t used = NumberIn(group / files.used), cache = NumberIn(group / "memory.stat", files.cache);
  return Difference(NumberIn(group / files.limit), cache == kUnlimited ? used : Difference(used, cache));
}

// The limits of a group hold with those of all that it is in. In a container its path may not be visible: then the
// files of the hierarchy's root are its own.
uint64_t LeftInHierarchy(const fs::path& hierarchy, const fs::path& group, const GroupFiles& files) {
  uint64_t left = LeftIn(hierarchy, files);
  fs::path at = hierarchy;
  for (const fs::path& part : group.relative_path()) left = std::min(left, LeftIn(at /= part, files));
  return left;
}

uint64_t AddressSpaceLeft() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnlimited;
  const uint64_t kib = NumberIn("/proc/self/status", "VmSize:");
  return Difference(limit.rlim_cur, kib == kUnlimited ? 0 : kib * 1024);
}

}  // namespace

uint64_t internal::GroupMemoryLeft(const fs::path& membership, const fs::path& root) {
  uint64_t left = std::min(LeftIn(root, kVersion2), LeftIn(root / "memory", kVersion1));
  std::ifstream in(membership);
  for (std::string line; std::getline(in, line);) {  // "4:memory:/group" (version 1), "0::/group" (version 2)
    const size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = fmt::format(",{},", line.substr(first + 1, second - first - 1));
    const fs::path group = line.substr(second + 1);
    if (controllers == ",,") left = std::min(left, LeftInHierarchy(root, group, kVersion2));
    if (controllers.find(",memory,") != std::string::npos)
      left = std::min(left, LeftInHierarchy(root / "memory", group, kVersion1));
  }
  return left;
}

uint64_t AvailableMemory() {
  const uint64_t kib = NumberIn("/proc/meminfo", "MemAvailable:");
  const uint64_t machine = kib == kUnlimited ? kUnlimited : kib * 1024;
  return std::min({machine, internal::GroupMemoryLeft("/proc/self/cgroup", "/sys/fs/cgroup"), AddressSpaceLeft()});
}

}  // namespace glint
