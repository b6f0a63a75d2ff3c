// Reads the lines and numbers of COLMAP's text files. Internal to colmap/.
#pragma once

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace glint::internal {

// One line at a time, split at blanks. Every failure throws InputError with file, line and what was being read.
class TextReader {
 public:
  explicit TextReader(const std::filesystem::path& file);

  bool NextLine();    // the next line as it is, perhaps empty; false at the end of the file
  bool NextRecord();  // the next line that is neither empty nor a comment

  // What the current line is about, for messages: "image 12". Kept until it is set again.
  void Describe(std::string_view kind, uint64_t id) { kind_ = kind, id_ = id; }
  std::string Record() const;

  bool AtEnd() const { return rest_.empty(); }
  std::string_view Token(std::string_view what);  // the next word; fails at the end of the line
  std::string_view Rest();                        // all that is left, without blanks around it

  template <class T>
  T Number(std::string_view what) {
    const std::string_view token = Token(what);
    const char* begin = token.data() + (token.front() == '+' ? 1 : 0);
    T value;
    const auto [end, error] = std::from_chars(begin, token.data() + token.size(), value);
    if constexpr (std::is_floating_point_v<T>) {
      if (error == std::errc::result_out_of_range) return OutOfRange(token);
    }
    if (error != std::errc() || end != token.data() + token.size()) FailNumber(what, token);
    return value;
  }

  [[noreturn]] void Fail(std::string_view what) const;
  const std::filesystem::path& path() const { return path_; }

 private:
  [[noreturn]] void FailNumber(std::string_view what, std::string_view token) const;
  double OutOfRange(std::string_view token) const;  // an underflow reads as 0, an overflow as infinity

  std::filesystem::path path_;
  std::vector<char> buffer_;
  std::ifstream in_;
  std::string line_;
  std::string_view rest_;
  uint64_t line_number_ = 0;
  std::string_view kind_;
  uint64_t id_ = 0;
};

}  // namespace glint::internal
