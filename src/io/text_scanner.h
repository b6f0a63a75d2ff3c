// Reads words and numbers from a text held in memory, for the ASCII mesh formats. Internal to io/.
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include "core/error.h"

namespace glint::internal {

class TextScanner {
 public:
  // Skips comments that begin with `comment` and end with the line ('\0': none).
  TextScanner(std::string_view text, const std::filesystem::path& path, char comment)
      : rest_(text), path_(path), comment_(comment) {}

  size_t remaining() const { return rest_.size(); }
  uint64_t line() const { return line_; }

  // The next line without its end; comments stay in. False at the end.
  bool NextLine(std::string_view& line) {
    if (rest_.empty()) return false;
    const size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++line_;
    return true;
  }

  // The next word, over line ends; empty at the end of the text.
  std::string_view NextWord() {
    while (!rest_.empty()) {
      const char c = rest_.front();
      if (c == comment_ && comment_ != '\0') {
        const size_t end = rest_.find('\n');
        rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end);
      } else if (IsBlank(c)) {
        if (c == '\n') ++line_;
        rest_.remove_prefix(1);
      } else {
        break;
      }
    }
    size_t length = 0;
    while (length < rest_.size() && !IsBlank(rest_[length])) ++length;
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return word;
  }

  // The next word of the current line; empty at its end.
  std::string_view NextWordInLine() {
    while (!rest_.empty() && rest_.front() != '\n' && IsBlank(rest_.front())) rest_.remove_prefix(1);
    if (rest_.empty() || rest_.front() == '\n' || (comment_ != '\0' && rest_.front() == comment_)) return {};
    size_t length = 0;
    while (length < rest_.size() && !IsBlank(rest_[length])) ++length;
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return word;
  }
  void SkipLine() {
    std::string_view ignored;
    NextLine(ignored);
  }

  template <class T>
  T Number(std::string_view what) {
    return ParseNumber<T>(NextWord(), what);
  }

  template <class T>
  T ParseNumber(std::string_view word, std::string_view what) const {
    if (word.empty()) Fail(fmt::format("expected {}, found the end of the file", what));
    std::string_view digits = word;
    if (digits.front() == '+') digits.remove_prefix(1);
    T value{};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const bool underflow = std::is_floating_point_v<T> && error == std::errc::result_out_of_range;
    if ((error != std::errc() && !underflow) || end != digits.data() + digits.size()) {
      Fail(fmt::format("expected {}, found '{}'", what, word.substr(0, 60)));
    }
    return underflow ? T{0} : value;
  }

  [[noreturn]] void Fail(std::string_view what) const {
    throw InputError(path_.string(), fmt::format("line {}", line_), what);
  }

 private:
  static bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }

  std::string_view rest_;
  std::filesystem::path path_;
  char comment_;
  uint64_t line_ = 1;
};

}  // namespace glint::internal
