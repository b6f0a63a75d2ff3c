#include "io/vdb_io.h"

#include <fmt/format.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <fstream>
#include <optional>

#include "core/atomic_file.h"
#include "core/check.h"
#include "core/error.h"
#include "io/vdb_head.h"
#include "sdf/level_set_impl.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

// The file's fixed head: magic number, format version, library version, whether offsets follow, UUID.
constexpr std::streamoff kUuidOffset = 8 + 4 + 4 + 4 + 1;
constexpr size_t kUuidLength = 36;

// OpenVDB marks every file with a random UUID. Equal level sets shall give equal files: a UUID made of the content.
void ReplaceUuid(const fs::path& file) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  std::string head(kUuidOffset + kUuidLength, '\0');
  GLINT_CHECK(stream.read(head.data(), static_cast<std::streamsize>(head.size())).good());
  GLINT_CHECK_EQ(head[kUuidOffset + 8], '-');
  uint64_t hash[2] = {0xcbf29ce484222325u, 0x84222325cbf29ce4u};  // FNV-1a from two starts
  std::vector<char> buffer(size_t{1} << 18);
  while (stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || stream.gcount() > 0) {
    for (std::streamsize i = 0; i < stream.gcount(); ++i) {
      for (uint64_t& h : hash) h = (h ^ static_cast<unsigned char>(buffer[i])) * 0x100000001b3u;
    }
  }
  stream.clear();
  const std::string digits = fmt::format("{:016x}{:016x}", hash[0], hash[1]);
  const std::string uuid = fmt::format("{}-{}-{}-{}-{}", digits.substr(0, 8), digits.substr(8, 4), digits.substr(12, 4),
                                       digits.substr(16, 4), digits.substr(20, 12));
  stream.seekp(kUuidOffset);
  stream.write(uuid.data(), kUuidLength);
  stream.flush();
  if (!stream) throw InputError(file.string(), "", "cannot be written");
}

std::string Describe(const openvdb::GridBase& grid) {
  return fmt::format("'{}' ({} grid of {})", grid.getName(), openvdb::GridBase::gridClassToString(grid.getGridClass()),
                     grid.valueType());
}

// The name of the grid to read.
std::string ChooseGrid(openvdb::io::File& file, const fs::path& path, std::vector<std::string>* notes) {
  std::vector<std::string> level_sets;
  std::string found;
  const openvdb::GridPtrVecPtr grids = file.readAllGridMetadata();  // a temporary would be gone in the loop
  for (const auto& grid : *grids) {
    found += (found.empty() ? "" : ", ") + Describe(*grid);
    if (grid->isType<openvdb::FloatGrid>() && grid->getGridClass() == openvdb::GRID_LEVEL_SET) {
      level_sets.push_back(grid->getName());
    }
  }
  if (level_sets.empty()) {
    throw InputError(
        path.string(), "",
        fmt::format("expected a grid of floats of the class level set, found {}", found.empty() ? "none" : found));
  }
  const bool has_usual = std::find(level_sets.begin(), level_sets.end(), kVdbGridName) != level_sets.end();
  std::string chosen = has_usual ? kVdbGridName : level_sets.front();
  if (level_sets.size() > 1 && notes) {
    notes->push_back(fmt::format("{}: holds {}; took '{}'", path.string(), found, chosen));
  }
  return chosen;
}

LevelSet CheckedLevelSet(openvdb::FloatGrid::Ptr grid, const fs::path& path) {
  const std::string record = fmt::format("grid '{}'", grid->getName());
  const openvdb::Vec3d voxel = grid->voxelSize();
  if (!grid->hasUniformVoxels() || !grid->transform().isLinear() || !(voxel[0] > 0) || !std::isfinite(voxel[0])) {
    throw InputError(path.string(), record,
                     fmt::format("expected cubic voxels, found {} x {} x {}", voxel[0], voxel[1], voxel[2]));
  }
  if (!(grid->background() > 0) || !std::isfinite(grid->background())) {
    throw InputError(path.string(), record,
                     fmt::format("expected a positive background, found {}", grid->background()));
  }
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    if (std::isfinite(*value)) continue;
    const openvdb::Coord x = value.getCoord();
    throw InputError(path.string(), record,
                     fmt::format("expected finite values, found {} at voxel ({}, {}, {})", *value, x[0], x[1], x[2]));
  }
  return MakeLevelSet(std::move(grid));
}

// Reads the whole grid now; cut and damaged files must not be found out later.
LevelSet ReadNow(const fs::path& path, std::vector<std::string>* notes) {
  internal::CheckVdbHead(path);
  openvdb::io::File file(path.string());
  file.setCopyMaxBytes(0);
  file.open(/*delayLoad=*/false);
  const std::string name = ChooseGrid(file, path, notes);
  return CheckedLevelSet(openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(name)), path);
}

}  // namespace

void WriteVdb(const fs::path& path, const LevelSet& level_set) {
  GLINT_CHECK(!level_set.empty());
  openvdb::initialize();
  // A shallow copy: the metadata of the caller's grid stays as it is.
  const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(level_set.impl().grid->copyGrid());
  grid->setName(kVdbGridName);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setIsInWorldSpace(true);
  grid->setCreator("Glint");
  grid->addStatsMetadata();
  WriteNamedFileAtomically(path, [&](const fs::path& temporary) {
    try {
      openvdb::io::File file(temporary.string());
      file.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
      file.write(openvdb::GridCPtrVec{grid});
    } catch (const openvdb::Exception& exception) {
      throw InputError(path.string(), "", fmt::format("cannot be written: {}", exception.what()));
    }
    ReplaceUuid(temporary);
    // OpenVDB does not say whether all bytes found room on the disk.
    try {
      internal::CheckVdbHead(temporary);
    } catch (const InputError&) {
      throw InputError(path.string(), "", "cannot be written whole: is the disk full?");
    }
  });
}

LevelSet ReadVdb(const fs::path& path, std::vector<std::string>* notes) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) throw InputError(path.string(), "", "expected an OpenVDB file, found none");
  openvdb::initialize();
  try {
    return ReadNow(path, notes);
  } catch (const openvdb::Exception& exception) {
    throw InputError(path.string(), "", fmt::format("expected a sound OpenVDB file: {}", exception.what()));
  } catch (const std::bad_alloc&) {
    throw InputError(path.string(), "", "expected a sound OpenVDB file that fits into memory");
  }
}

}  // namespace glint
