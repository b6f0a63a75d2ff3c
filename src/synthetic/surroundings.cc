#include "synthetic/surroundings.h"

#include <algorithm>
#include <cmath>

#include "synthetic/random.h"

namespace glint {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

uint64_t LatticeHash(double i, double j, uint64_t layer) {
  return MixBits(static_cast<uint64_t>(static_cast<int64_t>(i)) * 0x8da6b343u ^
                 static_cast<uint64_t>(static_cast<int64_t>(j)) * 0xd8163841cb1ab3f5u ^ layer);
}

double LatticeValue(double i, double j, uint64_t layer) { return UnitOfHash(LatticeHash(i, j, layer)); }

// Smooth noise in [0, 1] with features of unit size.
double ValueNoise(double x, double y, uint64_t layer) {
  const double i = std::floor(x), j = std::floor(y), u = x - i, v = y - j;
  const double s = u * u * (3 - 2 * u), t = v * v * (3 - 2 * v);
  const double below = (1 - s) * LatticeValue(i, j, layer) + s * LatticeValue(i + 1, j, layer);
  const double above = (1 - s) * LatticeValue(i, j + 1, layer) + s * LatticeValue(i + 1, j + 1, layer);
  return (1 - t) * below + t * above;
}

// 1 where a pattern of this wavelength is resolved, 0 where a pixel covers most of it.
double Resolved(double wavelength, double footprint) {
  return std::clamp(1.5 - 2.5 * footprint / wavelength, 0.0, 1.0);
}

}  // namespace

Surroundings::Surroundings(double ground_z, std::shared_ptr<const ShapeTracer> interior, uint64_t seed)
    : ground_z_(ground_z), interior_(std::move(interior)), seed_(MixBits(seed ^ 0x67726f756e64)) {
  Random random({seed, 21});
  const double turn = random.Uniform(0, 3.14159265);
  turn_cos_ = std::cos(turn);
  turn_sin_ = std::sin(turn);
  tile_ = random.Uniform(0.42, 0.6);
  const double warm = random.Uniform(-0.05, 0.08);
  palette_[0] = Array3d(0.30 + warm, 0.29, 0.27 - warm);
  palette_[1] = Array3d(0.20 + warm, 0.20, 0.20 - warm * 0.5);
  for (int i = 2; i < 4; ++i)
    palette_[i] = Array3d(random.Uniform(0.05, 0.5), random.Uniform(0.05, 0.4), random.Uniform(0.05, 0.4));
  for (int i = 0; i < 2; ++i) {
    const double azimuth = random.Uniform(0, 6.2831853), height = random.Uniform(0.2, 0.6);
    window_[i] = Vector3d(std::cos(azimuth), std::sin(azimuth), height).normalized();
  }
}

double Surroundings::Mottle(double x, double y, double footprint, int octaves, uint64_t layer) const {
  double sum = 0, amplitude = 0.5, frequency = 2;
  for (int i = 0; i < octaves; ++i, amplitude *= 0.6, frequency *= 2.3) {
    const double weight = Resolved(1 / frequency, footprint);
    if (weight == 0) break;
    sum += weight * amplitude * (ValueNoise(x * frequency, y * frequency, seed_ + layer + i) - 0.5);
  }
  return sum;
}

Array3d Surroundings::GroundAlbedo(double x, double y, double footprint) const {
  const double u = (turn_cos_ * x - turn_sin_ * y) / tile_, v = (turn_sin_ * x + turn_cos_ * y) / tile_;
  const double i = std::floor(u), j = std::floor(v);
  const uint64_t tile = LatticeHash(i, j, seed_ + 100);
  const double tiles = Resolved(1, footprint / tile_);
  const bool odd = (static_cast<int64_t>(i) + static_cast<int64_t>(j)) & 1;
  const Array3d mean = 0.5 * (palette_[0] + palette_[1]);
  Array3d color = mean + tiles * ((odd ? palette_[0] : palette_[1]) * (0.75 + 0.5 * UnitOfHash(tile)) - mean);
  // Joints between the tiles.
  const double joint = std::min({u - i, i + 1 - u, v - j, j + 1 - v});
  if (joint < 0.02) color *= 1 - 0.5 * Resolved(0.04, footprint / tile_);
  color *= 1 + 1.1 * Mottle(u, v, footprint / tile_, 4, 200);
  // A printed dot or square in some cells of a finer lattice.
  const double fine = 3.7, a = u * fine, b = v * fine, ia = std::floor(a), ib = std::floor(b);
  const uint64_t cell = LatticeHash(ia, ib, seed_ + 300);
  if (UnitOfHash(cell) < 0.35) {
    const double da = a - ia - 0.35 - 0.3 * UnitOfHash(MixBits(cell + 1));
    const double db = b - ib - 0.35 - 0.3 * UnitOfHash(MixBits(cell + 2));
    const double size = 0.12 + 0.18 * UnitOfHash(MixBits(cell + 3));
    const bool round = cell & 1;
    const double r = round ? std::hypot(da, db) : std::max(std::abs(da), std::abs(db));
    if (r < size && !(r < 0.5 * size && (cell & 2)))
      color += Resolved(2 * size / fine, footprint / tile_) * (palette_[2 + (cell >> 2 & 1)] - color);
  }
  return color.max(0.01).min(0.9);
}

Array3d Surroundings::InteriorAlbedo(const Vector3d& x, const Vector3d& normal, double footprint) const {
  // Laid on from the side that the surface faces most.
  int axis;
  normal.cwiseAbs().maxCoeff(&axis);
  const double u = x[(axis + 1) % 3], v = x[(axis + 2) % 3];
  return (Array3d(1.6, 1.15, 0.75) * GroundAlbedo(2.2 * u + 31 + 7 * axis, 2.2 * v - 17, 2.2 * footprint)).min(0.9);
}

Array3d Surroundings::Room(const Vector3d& direction) const {
  const double up = direction.normalized().z();
  const Array3d floor(0.13, 0.125, 0.12), wall(0.21, 0.205, 0.20), ceiling(0.33, 0.34, 0.36);
  const double s = 1 / (1 + std::exp(-9 * (up + 0.1))), t = 1 / (1 + std::exp(-5 * (up - 0.55)));
  Array3d color = floor + s * (wall - floor) + t * (ceiling - wall);
  for (const Vector3d& window : window_)
    color += 0.10 * std::exp(7 * (window.dot(direction) - 1)) * Array3d(0.92, 0.98, 1.08);
  return color;
}

Array3d Surroundings::Ambient(const Vector3d& normal) const {
  const double up = 0.5 + 0.5 * normal.z();
  return up * Array3d(0.26, 0.26, 0.265) + (1 - up) * Array3d(0.11, 0.105, 0.10);
}

}  // namespace glint
