// Reproducible random numbers: the same on every machine and for any number of threads.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>

namespace glint {

// A well-mixed 64-bit hash (the finaliser of SplitMix64).
inline uint64_t MixBits(uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

inline uint64_t HashOf(std::initializer_list<uint64_t> keys) {
  uint64_t hash = 0;
  for (uint64_t key : keys) hash = MixBits(hash ^ key);
  return hash;
}

// In [0, 1), from the high bits of a hash.
inline double UnitOfHash(uint64_t hash) { return static_cast<double>(hash >> 11) * 0x1p-53; }

// SplitMix64: small, good enough for scenes, and streams are independent for independent seeds.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(MixBits(seed)) {}
  Random(std::initializer_list<uint64_t> keys) : state_(HashOf(keys)) {}

  uint64_t Bits() { return MixBits(state_ += 0x9e3779b97f4a7c15ull); }
  double Uniform() { return UnitOfHash(Bits()); }
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  int Index(int count) { return static_cast<int>(Uniform() * count); }

  double Normal() {  // Box-Muller, one value a call
    const double radius = std::sqrt(-2 * std::log(1 - Uniform()));
    return radius * std::cos(2 * std::numbers::pi * Uniform());
  }

  Eigen::Vector3d UnitVector() {
    const double z = Uniform(-1, 1), angle = Uniform(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

 private:
  uint64_t state_;
};

}  // namespace glint
