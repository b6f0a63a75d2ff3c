// Preconditions. A failed check is a bug in the caller: it throws std::logic_error with the operands printed.
// Checks stay on in release builds; keep them out of inner loops.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace glint::internal {

[[noreturn]] void CheckFailed(const char* file, int line, const std::string& message);

template <class A, class B>
std::string DescribeOperands(const char* expression, const A& a, const B& b) {
  std::ostringstream out;
  out << "check failed: " << expression << " (" << a << " against " << b << ")";
  return out.str();
}

}  // namespace glint::internal

#define GLINT_CHECK(condition)                                                                         \
  do {                                                                                                 \
    if (!(condition)) ::glint::internal::CheckFailed(__FILE__, __LINE__, "check failed: " #condition); \
  } while (false)

#define GLINT_CHECK_OP(a, op, b)                                                                                \
  do {                                                                                                          \
    const auto& glint_a = (a);                                                                                  \
    const auto& glint_b = (b);                                                                                  \
    if (!(glint_a op glint_b))                                                                                  \
      ::glint::internal::CheckFailed(__FILE__, __LINE__,                                                        \
                                     ::glint::internal::DescribeOperands(#a " " #op " " #b, glint_a, glint_b)); \
  } while (false)

#define GLINT_CHECK_EQ(a, b) GLINT_CHECK_OP(a, ==, b)
#define GLINT_CHECK_NE(a, b) GLINT_CHECK_OP(a, !=, b)
#define GLINT_CHECK_LT(a, b) GLINT_CHECK_OP(a, <, b)
#define GLINT_CHECK_LE(a, b) GLINT_CHECK_OP(a, <=, b)
#define GLINT_CHECK_GT(a, b) GLINT_CHECK_OP(a, >, b)
#define GLINT_CHECK_GE(a, b) GLINT_CHECK_OP(a, >=, b)
