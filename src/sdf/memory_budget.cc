#include "sdf/memory_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/available_memory.h"
#include "core/error.h"
#include "core/parallel.h"

namespace glint {

namespace {

// Measured as peak memory, rounded up: sdf_benchmark prints it.
constexpr double kLeafBytes = 2300;      // 512 floats, mask, pointers
constexpr double kBytesPerTree = 2.5e6;  // nodes of 4096³ voxels, up to eight about the origin
constexpr double kBytesPerTriangle = 100;
constexpr double kBytesPerTriangleByWinding = 400;
constexpr double kDenseBytesPerTriangle = 400;

double FreeBytes() { return static_cast<double>(AvailableMemory()); }

// Volume in voxels of all leaves that a band may touch: a surface crosses those within a slab of about their size, and
// a triangle without width those within a tube.
double VolumeOfLeaves(const TriangleMesh& mesh, double reach, double voxel_size) {
  const double slab = 2 * reach + 8, tube = std::numbers::pi * (reach + 4) * (reach + 4);
  const double ball = 8 * std::pow(reach + 4, 3);
  return ball + ParallelSum(mesh.faces.size(), 16384, 0.0, [&](size_t begin, size_t end) {
           double part = 0;
           for (size_t f = begin; f < end; ++f) {
             const Eigen::Vector3i& v = mesh.faces[f];
             const Eigen::Vector3d u = mesh.vertices[v[1]] - mesh.vertices[v[0]],
                                   w = mesh.vertices[v[2]] - mesh.vertices[v[0]];
             const double area = 0.5 * u.cross(w).norm() / (voxel_size * voxel_size);
             const double length = std::sqrt(std::max({u.squaredNorm(), w.squaredNorm(), (u - w).squaredNorm()}));
             part += area * slab;
             if (area * voxel_size < 0.01 * length) part += tube * length / voxel_size;  // narrower than 1/50 voxel
           }
           return part;
         });
}

}  // namespace

double PredictBandBytes(const TriangleMesh& mesh, double half_width_voxels, double voxel_size, bool by_winding) {
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  const Eigen::Array3d extent = box.sizes().array() / voxel_size + 2 * half_width_voxels;
  const double leaves = std::min(VolumeOfLeaves(mesh, half_width_voxels, voxel_size), (extent + 8).prod()) / 512;
  return kBytesPerTree + leaves * kLeafBytes +
         static_cast<double>(mesh.faces.size()) * (by_winding ? kBytesPerTriangleByWinding : kBytesPerTriangle);
}

double CheckGridFits(const TriangleMesh& mesh, double half_width_voxels, double max_memory_gb, bool by_winding) {
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  const double largest = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  const double bytes = PredictBandBytes(mesh, half_width_voxels, 1, by_winding);
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
  return bytes;
}

double CheckDenseFits(double num_voxels, size_t num_faces) {
  const double bytes = num_voxels * sizeof(float) + static_cast<double>(num_faces) * kDenseBytesPerTriangle;
  if (bytes > FreeBytes())
    throw InputError("", "grid size",
                     fmt::format("{:.4g} voxels need about {:.3g} GB, and {:.3g} GB are free", num_voxels, bytes / 1e9,
                                 FreeBytes() / 1e9));
  return bytes;
}

}  // namespace glint
