// What an image file says of itself in its first bytes, read before a decoder allocates anything for it.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace glint {

struct ImageHeader {
  std::string_view format;  // "JPEG", "PNG", "TIFF", "BMP", "WebP" or "PNM"
  uint64_t width = 0, height = 0;
};

// nullopt: none of these formats, or cut before its size is said.
std::optional<ImageHeader> ReadImageHeader(std::string_view bytes);

// True if no file of `num_bytes` can hold so many pixels: deflate, the best of the compressions that pixels are stored
// with, packs 1032 bytes into one, and a byte may hold 8 pixels. (WebP says a plain image in a few bytes, whatever its
// size, which its format limits to 16384 squared.)
bool ClaimsTooMuch(const ImageHeader& header, uint64_t num_bytes);

}  // namespace glint
