// Random numbers by their place rather than by their turn: the same at any number of threads.
#pragma once

#include <cstdint>

namespace glint {

// 64 bits for place `i` of the stream `seed` (the mixing step of SplitMix64, Steele et al. 2014).
constexpr uint64_t RandomBits(uint64_t seed, uint64_t i) {
  uint64_t z = (seed + 1) * 0x9E3779B97F4A7C15u + i * 0xD1B54A32D192ED03u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

}  // namespace glint
