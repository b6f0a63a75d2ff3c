#include "seed/stiffness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "geometry/closest_point.h"

namespace glint {
namespace {

constexpr std::array<double, 4> kStiffer = {1, 1.6, 2.5, 4};  // times the smoothing asked for
constexpr size_t kHoldEvery = 4, kFewestHeld = 15;
// A tenth of the points may be mismatches; of an outline the few places on a lip matter, other views confirmed it.
constexpr std::array<size_t, 2> kBelievedPercent = {90, 98};
constexpr int kRounds = 3;  // the surface is smooth already

struct Score {
  double error = 0;      // mean square distance without the worst ones
  double deviation = 0;  // of that
};

Score ScoreOf(std::vector<double> squared, size_t believed_percent) {
  std::sort(squared.begin(), squared.end());
  squared.resize(squared.size() * believed_percent / 100);
  const double n = static_cast<double>(squared.size());
  const double mean = std::accumulate(squared.begin(), squared.end(), 0.0) / n;
  double scatter = 0;
  for (const double s : squared) scatter += (s - mean) * (s - mean);
  return {mean, std::sqrt(scatter / (n - 1) / n)};
}

using Squared = std::array<std::vector<double>, 2>;  // of sparse points, and of those of outlines

// How far every fourth sparse point, and every fourth one of outlines, is off a surface faired through the others.
Squared HeldOutErrors(const TriangleMesh& smooth, const std::vector<Attachment>& attachments,
                      const FairContext& context, FairOptions options) {
  std::vector<Attachment> kept, held;
  std::array<size_t, 2> count = {0, 0};
  for (const Attachment& a : attachments) {
    const bool foot = a.point < 0 && !a.extra;
    (!foot && count[a.extra]++ % kHoldEvery == 0 ? held : kept).push_back(a);
  }
  options.rounds = std::min(options.rounds, kRounds);
  // Of the same length in the world, with fewer points.
  options.smoothing *= std::sqrt(1 - 1.0 / kHoldEvery);
  const FairResult fair = FairThroughPoints(smooth, kept, context, options);
  const ClosestPointQuery query(fair.mesh);
  Squared squared;
  for (const Attachment& a : held) squared[a.extra].push_back(query.Find(a.position)->squared_distance);
  return squared;
}

size_t Stiffest(const std::array<Squared, kStiffer.size()>& squared, int extra) {
  std::array<Score, kStiffer.size()> scores;
  for (size_t i = 0; i < kStiffer.size(); ++i) scores[i] = ScoreOf(squared[i][extra], kBelievedPercent[extra]);
  const Score best =
      *std::min_element(scores.begin(), scores.end(), [](const Score& a, const Score& b) { return a.error < b.error; });
  size_t stiffest = kStiffer.size() - 1;
  while (scores[stiffest].error > best.error + best.deviation) --stiffest;
  return stiffest;
}

}  // namespace

double SmoothingByHoldingOut(const TriangleMesh& smooth, const std::vector<Attachment>& attachments,
                             const FairContext& context, const FairOptions& options) {
  std::array<Squared, kStiffer.size()> squared;
  ParallelFor(kStiffer.size(), 1, [&](size_t i) {
    FairOptions stiffer = options;
    stiffer.smoothing *= kStiffer[i];
    squared[i] = HeldOutErrors(smooth, attachments, context, stiffer);
  });
  if (squared[0][0].size() < kFewestHeld) return options.smoothing;
  size_t stiffest = kStiffer.size() - 1;
  for (int extra = 0; extra < 2; ++extra)
    if (squared[0][extra].size() >= kFewestHeld) stiffest = std::min(stiffest, Stiffest(squared, extra));
  return options.smoothing * kStiffer[stiffest];
}

}  // namespace glint
