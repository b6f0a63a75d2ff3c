#include "sdf/leaf_signs.h"

namespace glint::internal {

namespace {

// Bits that stay in their row of eight when shifted up by 1, 2, 4.
constexpr uint64_t kUp[3] = {0xfefefefefefefefeull, 0xfcfcfcfcfcfcfcfcull, 0xf0f0f0f0f0f0f0f0ull};
constexpr uint64_t kDown[3] = {0x7f7f7f7f7f7f7f7full, 0x3f3f3f3f3f3f3f3full, 0x0f0f0f0f0f0f0f0full};

// Unknown voxels take the side of the nearest known one before, then behind them: first along z, then along y.
void SpreadInSlice(uint64_t& known, uint64_t& inside) {
  for (int i = 0; i < 3; ++i) {
    const int s = 1 << i;
    inside |= (inside << s) & ~known & kUp[i];
    known |= (known << s) & kUp[i];
  }
  for (int i = 0; i < 3; ++i) {
    const int s = 1 << i;
    inside |= (inside >> s) & ~known & kDown[i];
    known |= (known >> s) & kDown[i];
  }
  for (int s = 8; s < 64; s *= 2) {
    inside |= (inside << s) & ~known;
    known |= known << s;
  }
  for (int s = 8; s < 64; s *= 2) {
    inside |= (inside >> s) & ~known;
    known |= known >> s;
  }
}

}  // namespace

LeafBits SpreadSides(const LeafBits& known_in, const LeafBits& inside_in) {
  LeafBits known = known_in, inside = inside_in;
  for (int x = 0; x < 8; ++x) {
    inside[x] &= known[x];
    if (known[x] != 0) SpreadInSlice(known[x], inside[x]);
  }
  for (int x = 1; x < 8; ++x)
    if (known[x] == 0) known[x] = known[x - 1], inside[x] = inside[x - 1];
  for (int x = 6; x >= 0; --x)
    if (known[x] == 0) known[x] = known[x + 1], inside[x] = inside[x + 1];
  return inside;
}

}  // namespace glint::internal
