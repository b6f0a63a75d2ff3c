#include "io/jpeg_check.h"

#include <jerror.h>
#include <jpeglib.h>

#include <csetjmp>
#include <cstdio>

namespace glint::internal {
namespace {

// libjpeg reports through function pointers in its error manager; `base` comes first, so that a pointer to it is one
// to the whole.
struct ErrorManager {
  jpeg_error_mgr base;
  std::jmp_buf escape;
  bool is_damaged;
  char message[JMSG_LENGTH_MAX];
};

void Note(j_common_ptr info) {
  auto* manager = reinterpret_cast<ErrorManager*>(info->err);
  if (!manager->is_damaged) manager->base.format_message(info, manager->message);
  manager->is_damaged = true;
}

// Fatal: libjpeg must not go on, and C code may not be left by an exception.
void OnError(j_common_ptr info) {
  Note(info);
  std::longjmp(reinterpret_cast<ErrorManager*>(info->err)->escape, 1);
}

void OnMessage(j_common_ptr info, int level) {
  if (level >= 0) return;  // a trace
  switch (info->err->msg_code) {
    case JWRN_HIT_MARKER:
    case JWRN_HUFF_BAD_CODE:
    case JWRN_JPEG_EOF:
    case JWRN_MUST_RESYNC:
      Note(info);
      break;
    default:
      break;
  }
}

// A progressive file may say each pixel again and again, at the cost of a whole image for a few bytes.
void OnProgress(j_common_ptr info) {
  constexpr int kMaxScans = 200;  // encoders write about 10
  auto* decoder = reinterpret_cast<j_decompress_ptr>(info);
  if (decoder->input_scan_number <= kMaxScans) return;
  auto* manager = reinterpret_cast<ErrorManager*>(info->err);
  manager->is_damaged = true;
  std::snprintf(manager->message, sizeof(manager->message), "it has more than %d scans", kMaxScans);
  std::longjmp(manager->escape, 1);
}

// Nothing here has a destructor: longjmp leaves it.
void DecodeCoefficients(const unsigned char* bytes, size_t size, ErrorManager* manager) {
  jpeg_decompress_struct decoder;
  decoder.err = jpeg_std_error(&manager->base);
  manager->base.error_exit = OnError;
  manager->base.emit_message = OnMessage;
  jpeg_create_decompress(&decoder);
  jpeg_progress_mgr progress = {};
  progress.progress_monitor = OnProgress;
  decoder.progress = &progress;
  if (setjmp(manager->escape) == 0) {
    jpeg_mem_src(&decoder, bytes, size);
    jpeg_read_header(&decoder, TRUE);
    jpeg_read_coefficients(&decoder);
    jpeg_finish_decompress(&decoder);
  }
  jpeg_destroy_decompress(&decoder);
}

}  // namespace

std::optional<std::string> JpegDamage(const unsigned char* bytes, size_t size) {
  ErrorManager manager = {};
  DecodeCoefficients(bytes, size, &manager);
  if (!manager.is_damaged) return std::nullopt;
  return std::string(manager.message);
}

}  // namespace glint::internal
