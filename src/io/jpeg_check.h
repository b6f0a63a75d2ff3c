// Finds damage that image decoders pass over in silence. Internal to io/.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace glint::internal {

// What is wrong with the compressed data of a JPEG (cut, damaged, not decodable), in libjpeg's words; nullopt if it is
// whole. Costs the entropy decoding, about a third of reading the image. Padding between parts, as some cameras
// write it, is no damage.
std::optional<std::string> JpegDamage(const unsigned char* bytes, size_t size);

inline bool IsJpeg(const unsigned char* bytes, size_t size) {
  return size >= 3 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF;
}

}  // namespace glint::internal
