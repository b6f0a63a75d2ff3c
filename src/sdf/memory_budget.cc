#include "sdf/memory_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "core/error.h"

namespace glint {

namespace {

constexpr double kLeafBytes = 2300;  // 512 floats, mask, pointers
constexpr double kBytesPerTriangle = 500;

double FreeBytes() {
  std::ifstream in("/proc/meminfo");
  for (std::string key; in >> key;) {
    double kilobytes;
    if (key == "MemAvailable:" && in >> kilobytes) return 1024 * kilobytes;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

double PredictBandBytes(const TriangleMesh& mesh, double half_width_voxels, double voxel_size) {
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  const double reach = half_width_voxels;
  const Eigen::Array3d extent = box.sizes().array() / voxel_size + 2 * reach;
  // The band's volume, at most that of the box; a surface of area A crosses leaves in a slab of about their size.
  const double slab = SurfaceArea(mesh) / (voxel_size * voxel_size) * (2 * reach + 8) + 8 * std::pow(reach + 4, 3);
  const double leaves = std::min(slab, (extent + 8).prod()) / 512;
  return leaves * kLeafBytes + static_cast<double>(mesh.faces.size()) * kBytesPerTriangle;
}

void CheckGridFits(const TriangleMesh& mesh, double half_width_voxels, double max_memory_gb) {
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  const double largest = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  const double bytes = PredictBandBytes(mesh, half_width_voxels);
  const double available = max_memory_gb > 0 ? max_memory_gb * 1e9 : FreeBytes();
  if (bytes > available)
    throw InputError(
        "", "voxel size",
        fmt::format("a band of ±{} voxels over {:.4g} × {:.4g} × {:.4g} voxels needs about {:.3g} GB, and "
                    "{:.3g} GB are allowed; choose larger voxels",
                    half_width_voxels, box.sizes()[0], box.sizes()[1], box.sizes()[2], bytes / 1e9, available / 1e9));
  if (!(largest + half_width_voxels + 16 < 2147483647.0))
    throw InputError(
        "", "voxel size",
        fmt::format("the mesh reaches {:.4g} voxels from the origin, and a grid can hold 2147483647; choose "
                    "larger voxels or move the mesh",
                    largest));
}

double CheckDenseFits(double num_voxels, size_t num_faces) {
  const double bytes = num_voxels * sizeof(float) + static_cast<double>(num_faces) * kBytesPerTriangle;
  if (bytes > FreeBytes())
    throw InputError("", "grid size",
                     fmt::format("{:.4g} voxels need about {:.3g} GB, and {:.3g} GB are free", num_voxels, bytes / 1e9,
                                 FreeBytes() / 1e9));
  return bytes;
}

}  // namespace glint
