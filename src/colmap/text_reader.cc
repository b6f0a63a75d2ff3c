#include "colmap/text_reader.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "core/error.h"

namespace glint::internal {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && IsBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsBlank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

TextReader::TextReader(const std::filesystem::path& file) : path_(file), buffer_(size_t{1} << 18) {
  std::error_code error;
  if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error))
    throw InputError(file.string(), "", "expected a file");  // a pipe would wait for its writer
  in_.rdbuf()->pubsetbuf(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  errno = 0;
  in_.open(file, std::ios::binary);
  if (!in_) throw InputError(file.string(), "", fmt::format("cannot be opened: {}", std::strerror(errno)));
}

bool TextReader::NextLine() {
  if (!std::getline(in_, line_)) {
    if (in_.bad()) Fail("cannot be read");
    rest_ = {};
    return false;
  }
  ++line_number_;
  rest_ = Trimmed(line_);
  if (line_number_ == 1 && rest_.starts_with("\xEF\xBB\xBF")) rest_ = Trimmed(rest_.substr(3));  // byte-order mark
  return true;
}

bool TextReader::NextRecord() {
  kind_ = {};
  while (NextLine()) {
    if (!rest_.empty() && rest_.front() != '#') return true;
  }
  return false;
}

std::string TextReader::Record() const {
  if (line_number_ == 0) return "";
  return kind_.empty() ? fmt::format("line {}", line_number_)
                       : fmt::format("line {} ({} {})", line_number_, kind_, id_);
}

std::string_view TextReader::Token(std::string_view what) {
  if (rest_.empty()) Fail(fmt::format("expected {}, found the end of the line", what));
  size_t length = 0;
  while (length < rest_.size() && !IsBlank(rest_[length])) ++length;
  const std::string_view token = rest_.substr(0, length);
  while (length < rest_.size() && IsBlank(rest_[length])) ++length;
  rest_.remove_prefix(length);
  return token;
}

std::string_view TextReader::Rest() {
  const std::string_view rest = rest_;
  rest_ = {};
  return rest;
}

void TextReader::Fail(std::string_view what) const { throw InputError(path_.string(), Record(), what); }

void TextReader::FailNumber(std::string_view what, std::string_view token) const {
  Fail(fmt::format("expected {}, found '{}'", what, token.substr(0, 80)));
}

double TextReader::OutOfRange(std::string_view token) const { return std::strtod(std::string(token).c_str(), nullptr); }

}  // namespace glint::internal
