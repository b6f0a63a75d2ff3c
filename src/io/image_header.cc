#include "io/image_header.h"

#include <array>
#include <charconv>

namespace glint {
namespace {

using Header = std::optional<ImageHeader>;

// Numbers at a place of the file; 0 beyond its end.
class Bytes {
 public:
  Bytes(std::string_view bytes, bool is_big_endian) : bytes_(bytes), is_big_endian_(is_big_endian) {}
  bool Has(uint64_t at, uint64_t count) const { return at <= bytes_.size() && count <= bytes_.size() - at; }
  uint64_t Number(uint64_t at, int count) const {
    if (!Has(at, static_cast<uint64_t>(count))) return 0;
    uint64_t value = 0;
    for (int i = 0; i < count; ++i) {
      const uint64_t byte = static_cast<unsigned char>(bytes_[at + static_cast<uint64_t>(i)]);
      value |= byte << 8 * (is_big_endian_ ? count - 1 - i : i);
    }
    return value;
  }

 private:
  std::string_view bytes_;
  bool is_big_endian_;
};

Header Found(std::string_view format, uint64_t width, uint64_t height) {
  if (width == 0 || height == 0) return std::nullopt;
  return ImageHeader{format, width, height};
}

// Segments one after the other up to the frame, which says the size.
Header Jpeg(std::string_view file) {
  const Bytes bytes(file, true);
  for (uint64_t at = 2; bytes.Has(at, 4);) {
    if (bytes.Number(at, 1) != 0xFF) {
      ++at;  // padding that some cameras write
      continue;
    }
    const uint64_t marker = bytes.Number(at + 1, 1);
    if (marker == 0xFF || marker == 0x00 || marker == 0x01 || (marker >= 0xD0 && marker <= 0xD8)) {
      at += marker == 0xFF ? 1 : 2;  // fill bytes, and markers that stand alone
      continue;
    }
    if (marker == 0xD9 || marker == 0xDA) return std::nullopt;
    const bool is_frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (is_frame) return Found("JPEG", bytes.Number(at + 7, 2), bytes.Number(at + 5, 2));
    at += 2 + bytes.Number(at + 2, 2);
  }
  return std::nullopt;
}

Header Tiff(std::string_view file) {
  const Bytes bytes(file, file[0] == 'M');
  const uint64_t directory = bytes.Number(4, 4), num_entries = bytes.Number(directory, 2);
  uint64_t width = 0, height = 0;
  for (uint64_t i = 0; i < num_entries; ++i) {
    const uint64_t entry = directory + 2 + 12 * i;
    const uint64_t tag = bytes.Number(entry, 2), type = bytes.Number(entry + 2, 2);
    const uint64_t value = bytes.Number(entry + 8, type == 3 ? 2 : type == 1 ? 1 : 4);
    if (tag == 256 && width == 0) width = value;
    if (tag == 257 && height == 0) height = value;
  }
  return Found("TIFF", width, height);
}

Header Bmp(std::string_view file) {
  const Bytes bytes(file, false);
  if (bytes.Number(14, 4) == 12) return Found("BMP", bytes.Number(18, 2), bytes.Number(20, 2));
  const uint64_t height = bytes.Number(22, 4);
  const bool is_upside_down = height >= 0x80000000u;
  return Found("BMP", bytes.Number(18, 4), is_upside_down ? 0x100000000u - height : height);
}

Header WebP(std::string_view file) {
  const Bytes bytes(file, false);
  const std::string_view kind = file.substr(12, 4);
  if (kind == "VP8X") return Found("WebP", bytes.Number(24, 3) + 1, bytes.Number(27, 3) + 1);
  if (kind == "VP8L") {
    const uint64_t bits = bytes.Number(21, 4);
    return Found("WebP", (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1);
  }
  return Found("WebP", bytes.Number(26, 2) & 0x3FFF, bytes.Number(28, 2) & 0x3FFF);
}

// "P5", then width and height in digits, with blanks and comments between them.
Header Pnm(std::string_view file) {
  std::array<uint64_t, 2> size = {0, 0};
  size_t at = 2;
  for (uint64_t& value : size) {
    while (at < file.size() && (file[at] < '0' || file[at] > '9')) {
      if (file[at] == '#') at = std::min(file.find('\n', at), file.size() - 1);
      ++at;
    }
    const auto [end, error] =
        std::from_chars(file.data() + std::min(at, file.size()), file.data() + file.size(), value);
    if (error != std::errc()) return std::nullopt;
    at = static_cast<size_t>(end - file.data());
  }
  return Found("PNM", size[0], size[1]);
}

}  // namespace

Header ReadImageHeader(std::string_view file) {
  if (file.starts_with("\xFF\xD8\xFF")) return Jpeg(file);
  if (file.starts_with(std::string_view("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16))) {
    const Bytes bytes(file, true);
    return Found("PNG", bytes.Number(16, 4), bytes.Number(20, 4));
  }
  if (file.starts_with(std::string_view("II*\0", 4)) || file.starts_with(std::string_view("MM\0*", 4)))
    return Tiff(file);
  if (file.starts_with("BM")) return Bmp(file);
  if (file.size() >= 30 && file.starts_with("RIFF") && file.substr(8, 4) == "WEBP") return WebP(file);
  if (file.size() >= 3 && file[0] == 'P' && file[1] >= '1' && file[1] <= '6') return Pnm(file);
  return std::nullopt;
}

bool ClaimsTooMuch(const ImageHeader& header, uint64_t num_bytes) {
  constexpr uint64_t kMaxSide = 1'000'000, kMaxPixelsPerByte = 8256;
  if (header.width > kMaxSide || header.height > kMaxSide) return true;
  return header.format != "WebP" && header.width * header.height / kMaxPixelsPerByte > num_bytes;
}

}  // namespace glint
