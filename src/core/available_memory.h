// How much memory this process may still take.
#pragma once

#include <cstdint>
#include <filesystem>

namespace glint {

// Bytes: the least of what the machine has free, what its control groups (version 1 or 2, with all that are above)
// leave, and its address-space limit (ulimit -v).
uint64_t AvailableMemory();

namespace internal {

// What the groups that `membership` (/proc/self/cgroup) names leave, with their files below `root` (/sys/fs/cgroup);
// the largest number if none limits.
uint64_t GroupMemoryLeft(const std::filesystem::path& membership, const std::filesystem::path& root);

}  // namespace internal
}  // namespace glint
