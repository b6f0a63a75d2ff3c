#pragma once

namespace glint {

// x², correctly rounded. std::pow(x, 2) is the same only where the compiler replaces it by a product; the library's own
// is off in the last bit for one in a thousand, and builds with and without optimisation would part.
constexpr double Square(double x) { return x * x; }

}  // namespace glint
