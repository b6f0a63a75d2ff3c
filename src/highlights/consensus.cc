#include "highlights/consensus.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"

namespace glint {
namespace {

constexpr size_t kFewest = 8;
constexpr double kMinSigmaDeg = 1.5;
constexpr double kLeastReachDeg = 10;
constexpr double kMedianOfRayleigh = 1.18;  // in standard deviations
constexpr double kClearlyOff = 5.5;         // in standard deviations: the errors of a rough seed have heavy tails
constexpr double kNarrow = 0.4;             // of the median width
constexpr double kTellingWidthDeg = 3;      // of sharper gloss the seed's facets decide how wide it looks
constexpr int kRounds = 30;

double Radians(double deg) { return deg * M_PI / 180; }

// Density over the angle (radians) of directions that err by sigma.
double OfError(double angle, double sigma) {
  return angle / (sigma * sigma) * std::exp(-0.5 * angle * angle / (sigma * sigma));
}

// Logarithm of the likelihood of angles all of which are errors, of the most likely sigma.
double LogLikelihoodOfErrors(const std::vector<double>& angles_deg) {
  double squares = 0, sum = 0;
  for (double deg : angles_deg) squares += Radians(deg) * Radians(deg);
  const double sigma = std::sqrt(0.5 * squares / static_cast<double>(angles_deg.size()));
  for (double deg : angles_deg) sum += std::log(std::max(OfError(Radians(deg), sigma), 1e-300));
  return sum;
}

// Angles above this are rather chance than error, degrees; 90 where errors alone explain them as well (Bayesian
// information criterion: the few highlights of a poor seed are off by much, and none by chance). Chance reaches as far
// as the angles do: what is farther off has not come this far.
double LargestErrorDeg(std::vector<double> angles_deg) {
  std::sort(angles_deg.begin(), angles_deg.end());
  const double farthest = Radians(std::clamp(angles_deg.back(), kLeastReachDeg, 90.0));
  const auto of_chance = [&](double angle) { return std::sin(std::min(angle, M_PI / 2)) / (1 - std::cos(farthest)); };
  // The nearer half are mostly errors; theirs is the median.
  double sigma = std::max(Radians(angles_deg[angles_deg.size() / 4] / kMedianOfRayleigh), Radians(kMinSigmaDeg));
  double share = 0.5;
  const auto is_error = [&](double angle) {
    const double error = share * OfError(angle, sigma), chance = (1 - share) * of_chance(angle);
    return error / std::max(error + chance, 1e-300);
  };
  for (int round = 0; round < kRounds; ++round) {
    double squares = 0, sum = 0;
    for (double deg : angles_deg) {
      const double angle = Radians(deg), p = is_error(angle);
      squares += p * angle * angle;
      sum += p;
    }
    sigma = std::max(std::sqrt(0.5 * squares / std::max(sum, 1e-12)), Radians(kMinSigmaDeg));
    share = std::clamp(sum / static_cast<double>(angles_deg.size()), 0.05, 0.95);
  }
  double log_likelihood = 0;
  for (double deg : angles_deg)
    log_likelihood += std::log(share * OfError(Radians(deg), sigma) + (1 - share) * of_chance(Radians(deg)));
  const double gain = log_likelihood - LogLikelihoodOfErrors(angles_deg);
  if (2 * gain < std::log(static_cast<double>(angles_deg.size()))) return 90;
  double limit = kClearlyOff * sigma;
  while (limit < M_PI / 2 && is_error(limit) > 0.5) limit += Radians(0.1);
  return limit * 180 / M_PI;
}

}  // namespace

std::vector<Unlike> FindUnlike(const std::vector<SeenOnSeed>& seen, int num_lights) {
  std::vector<Unlike> unlike(seen.size(), Unlike::kNo);
  std::vector<double> angles_deg;
  for (const SeenOnSeed& s : seen) angles_deg.push_back(s.off_deg);
  if (angles_deg.size() < kFewest) return unlike;
  const double largest_deg = LargestErrorDeg(angles_deg);
  for (int light = 0; light < num_lights; ++light) {
    std::vector<double> widths_deg;
    for (size_t i = 0; i < seen.size(); ++i) {
      if (seen[i].light != light) continue;
      if (seen[i].off_deg > largest_deg)
        unlike[i] = Unlike::kNormal;
      else if (seen[i].width_deg)
        widths_deg.push_back(*seen[i].width_deg);
    }
    const double width_deg = Median(widths_deg);
    if (widths_deg.size() < kFewest || width_deg < kTellingWidthDeg) continue;
    for (size_t i = 0; i < seen.size(); ++i)
      if (seen[i].light == light && unlike[i] == Unlike::kNo && seen[i].width_deg &&
          *seen[i].width_deg < kNarrow * width_deg)
        unlike[i] = Unlike::kWidth;
  }
  return unlike;
}

}  // namespace glint
