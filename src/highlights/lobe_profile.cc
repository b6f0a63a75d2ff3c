#include "highlights/lobe_profile.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/square.h"

namespace glint {
namespace {

constexpr int kFewestPixels = 40;

// A GGX lobe of unit width, (1 + r²)^-2, averaged over a disc.
double Smeared(double r, double disc) {
  constexpr int kRings = 12, kSpokes = 16;
  double sum = 0;
  for (int i = 0; i < kRings; ++i) {
    const double s = disc * std::sqrt((i + 0.5) / kRings);
    for (int k = 0; k < kSpokes; ++k) {
      const double a = 2 * M_PI * (k + 0.5 * (i % 2)) / kSpokes;
      const double q = r * r + s * s - 2 * r * s * std::cos(a);
      sum += 1 / ((1 + q) * (1 + q));
    }
  }
  return sum / (kRings * kSpokes);
}

// Where the smeared lobe has fallen to `height` of its peak.
double RadiusAt(double height, double disc) {
  const double level = height * Smeared(0, disc);
  double low = 0, high = disc + 3;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (Smeared(middle, disc) > level ? low : high) = middle;
  }
  return low;
}

struct Row {
  double flatness, share;
};

// Both columns rise.
const std::vector<Row>& Table() {
  static const std::vector<Row> table = [] {
    std::vector<Row> rows;
    for (double disc = 0; disc <= 8; disc += disc < 2 ? 0.2 : 1) {
      const double half = RadiusAt(0.5, disc);
      const Row row{Square(RadiusAt(0.8, disc) / half), disc / half};
      if (rows.empty() || (row.flatness > rows.back().flatness && row.share > rows.back().share)) rows.push_back(row);
    }
    return rows;
  }();
  return table;
}

}  // namespace

double Flatness(const cv::Mat& map, const Blob& blob, double saturation) {
  if (blob.area < kFewestPixels || blob.peak_value >= saturation) return 0;
  const auto limit = static_cast<uint16_t>(65535 * (blob.body + 0.8 * (blob.peak_value - blob.body)));
  int high = 0;
  for (const PixelRun& run : blob.runs) {
    const uint16_t* values = map.ptr<uint16_t>(run.y) + run.x;
    high += static_cast<int>(std::count_if(values, values + run.length, [limit](uint16_t v) { return v > limit; }));
  }
  return static_cast<double>(high) / blob.area;
}

double DiscShare(double flatness) {
  const std::vector<Row>& table = Table();
  if (flatness <= table.front().flatness) return 0;
  for (size_t i = 1; i < table.size(); ++i)
    if (flatness < table[i].flatness) {
      const double t = (flatness - table[i - 1].flatness) / (table[i].flatness - table[i - 1].flatness);
      return table[i - 1].share + t * (table[i].share - table[i - 1].share);
    }
  return table.back().share;
}

}  // namespace glint
