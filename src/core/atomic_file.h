// Files that appear under their final name only when they are complete: written under a temporary name in the same
// folder, flushed to the disk, then renamed. A crash, a full disk or an exception leaves the old file, or none.
#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string_view>

namespace glint {

// Writes `bytes` as the file `path`, creating missing parent folders. Throws InputError naming `path` and the
// system's reason (no space left on device, permission denied, ...).
void WriteFileAtomically(const std::filesystem::path& path, std::string_view bytes);

// As above, for writers that stream. `write` need not check the stream: failures are found and reported here.
void WriteFileAtomically(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

// As above, for libraries that open files by name: `write` gets a temporary path with the extension of `path`.
void WriteNamedFileAtomically(const std::filesystem::path& path,
                              const std::function<void(const std::filesystem::path&)>& write);

}  // namespace glint
