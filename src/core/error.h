// The exceptions of Glint and what they mean to the person at the shell.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace glint {

// Base of everything Glint throws on purpose. Anything else that escapes is a bug (exit code 1).
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Bad file, folder, argument or configuration (exit code 2). The message reads "PATH: RECORD: WHAT",
// where WHAT says what was expected and what was found. `path` and `record` may be empty.
class InputError : public Error {
 public:
  InputError(std::string_view path, std::string_view record, std::string_view what);
  const std::string& path() const { return path_; }
  const std::string& record() const { return record_; }

 private:
  std::string path_;
  std::string record_;
};

// The input was sound but no honest result can be given from it, for example no highlights were found
// (exit code 3). Thrown only by pipeline/; stages report weak outcomes as values in their summaries.
class NoResultError : public Error {
 public:
  using Error::Error;
};

// The user asked to stop (Ctrl-C); finished work is kept.
class CancelledError : public Error {
 public:
  CancelledError() : Error("cancelled") {}
};

}  // namespace glint
