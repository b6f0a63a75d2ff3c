#include "silhouette/segment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>
#include <utility>
#include <vector>

#include "core/square.h"
#include "silhouette/lab.h"

namespace glint::internal {
namespace {

constexpr int kColors = 28;             // clusters of a photograph's colours
constexpr int kColorSamples = 6000;     // for finding them
constexpr double kWindowRel = 0.10;     // of the raster: how far around a pixel colours are learned from
constexpr double kGlobal = 0.03;        // weight of what is learned from everywhere, against around
constexpr double kMaxEvidence = 3.5;    // of one pixel's colour, log of odds
constexpr double kHintEvidence = 8;     // of a sparse point
constexpr double kPriorEvidence = 1.5;  // against the object at the end of its reach
constexpr double kEdge = 9;             // cost of a border without contrast
constexpr double kMinEdge = 0.4;        // and with any contrast
constexpr double kSure = 1e6;
constexpr int kRounds = 3;
constexpr int kCoreRounds = 2;
constexpr int kShrink = 8;  // of the raster, for windows

enum : uint8_t { kUnknown, kObject, kSurroundings };

// Per pixel the number of the nearest of kColors typical colours.
cv::Mat ColorLabels(const cv::Mat& lab) {
  const int stride = std::max(1, static_cast<int>(lab.total() / kColorSamples));
  std::vector<cv::Vec3f> samples;
  for (size_t i = 0; i < lab.total(); i += stride) samples.push_back(lab.at<cv::Vec3f>(static_cast<int>(i)));
  const int count = std::min<int>(kColors, static_cast<int>(samples.size()));
  cv::Mat best, centers;
  const uint64_t state = cv::theRNG().state;
  cv::theRNG().state = 12345;
  cv::kmeans(cv::Mat(samples).reshape(1), count, best, cv::TermCriteria(cv::TermCriteria::COUNT, 8, 0), 1,
             cv::KMEANS_PP_CENTERS, centers);
  cv::theRNG().state = state;
  cv::Mat labels(lab.size(), CV_8U);
  for (int y = 0; y < lab.rows; ++y)
    for (int x = 0; x < lab.cols; ++x) {
      const cv::Vec3f& c = lab.at<cv::Vec3f>(y, x);
      double least = 1e30;
      for (int k = 0; k < count; ++k) {
        const float* m = centers.ptr<float>(k);
        const double d = Square(c[0] - m[0]) + Square(c[1] - m[1]) + Square(c[2] - m[2]);
        if (d < least) {
          least = d;
          labels.at<uint8_t>(y, x) = static_cast<uint8_t>(k);
        }
      }
    }
  return labels;
}

// One axis of pixels, cut into even cells of at most kShrink.
class Cells {
 public:
  explicit Cells(int pixels) : count_((pixels + kShrink - 1) / kShrink), width_(static_cast<double>(pixels) / count_) {
    for (int p = 0; p < pixels; ++p) {
      const int cell = std::min(static_cast<int>(p / width_), count_ - 1);
      const double within = std::min(1.0, (cell + 1) * width_ - p);
      shares_.push_back({cell, std::min(cell + 1, count_ - 1), static_cast<float>(within)});
      const double at = std::clamp((p + 0.5) / width_ - 0.5, 0.0, count_ - 1.0);
      const int low = static_cast<int>(at);
      around_.push_back({low, std::min(low + 1, count_ - 1), static_cast<float>(low + 1 - at)});
    }
  }

  struct Pair {
    int first, second;
    float weight;  // of the first; the rest is the second's
  };
  int count() const { return count_; }
  double width() const { return width_; }
  const Pair& SharesOf(int pixel) const { return shares_[pixel]; }  // the cells that it lies in
  const Pair& Around(int pixel) const { return around_[pixel]; }    // those whose centres it lies between

 private:
  int count_;
  double width_;
  std::vector<Pair> shares_, around_;
};

// Where each colour was seen, and where any: as shares of cells, from there taken around every pixel and, with less
// weight, from everywhere.
class ColorsAround {
 public:
  // Among the pixels that are known to be `which`.
  ColorsAround(const cv::Mat& labels, const cv::Mat& known, uint8_t which)
      : columns_(labels.cols), rows_(labels.rows), cells_(kColors + 1) {
    for (cv::Mat& c : cells_) c = cv::Mat(rows_.count(), columns_.count(), CV_32F, cv::Scalar(0));
    for (int y = 0; y < labels.rows; ++y)
      for (int x = 0; x < labels.cols; ++x) {
        if (known.at<uint8_t>(y, x) != which) continue;
        Count(cells_[labels.at<uint8_t>(y, x)], x, y);
        Count(cells_[kColors], x, y);
      }
    const double sigma = kWindowRel * std::max(labels.cols, labels.rows) / kShrink;
    for (cv::Mat& c : cells_) {
      c *= 1 / (columns_.width() * rows_.width());
      const double everywhere = cv::mean(c)[0];
      cv::GaussianBlur(c, c, cv::Size(), sigma, sigma, cv::BORDER_CONSTANT);
      c += kGlobal * everywhere;
    }
  }

  // Of what is seen around a pixel, the share that has this colour.
  double Share(int color, int x, int y) const {
    return At(cells_[color], x, y) / std::max(1e-6F, At(cells_[kColors], x, y));
  }

 private:
  void Count(cv::Mat& cells, int x, int y) const {
    const Cells::Pair &u = columns_.SharesOf(x), &v = rows_.SharesOf(y);
    float *low = cells.ptr<float>(v.first), *high = cells.ptr<float>(v.second);
    low[u.first] += u.weight * v.weight, low[u.second] += (1 - u.weight) * v.weight;
    high[u.first] += u.weight * (1 - v.weight), high[u.second] += (1 - u.weight) * (1 - v.weight);
  }
  float At(const cv::Mat& cells, int x, int y) const {
    const Cells::Pair &u = columns_.Around(x), &v = rows_.Around(y);
    const float *low = cells.ptr<float>(v.first), *high = cells.ptr<float>(v.second);
    return v.weight * (u.weight * low[u.first] + (1 - u.weight) * low[u.second]) +
           (1 - v.weight) * (u.weight * high[u.first] + (1 - u.weight) * high[u.second]);
  }

  Cells columns_, rows_;
  std::vector<cv::Mat> cells_;
};

// Log of the odds that a pixel is the object's by its colour, learned from pixels around it that are known.
cv::Mat ColorEvidence(const cv::Mat& labels, const cv::Mat& known) {
  const ColorsAround object(labels, known, kObject), around(labels, known, kSurroundings);
  cv::Mat evidence(labels.size(), CV_32F, cv::Scalar(0));
  constexpr double kLeast = 0.25 / kColors;  // share of a colour that was not seen
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x) {
      const int color = labels.at<uint8_t>(y, x);
      const double p = object.Share(color, x, y), q = around.Share(color, x, y);
      evidence.at<float>(y, x) =
          static_cast<float>(std::clamp(std::log((p + kLeast) / (q + kLeast)), -kMaxEvidence, kMaxEvidence));
    }
  return evidence;
}

constexpr std::array<std::array<int, 2>, 4> kNeighbors = {{{1, 0}, {0, 1}, {1, 1}, {-1, 1}}};

double SquaredContrast(const cv::Mat& lab, int x, int y, int nx, int ny) {
  const cv::Vec3f d = lab.at<cv::Vec3f>(y, x) - lab.at<cv::Vec3f>(ny, nx);
  return d.dot(d);
}

template <class Visit>
void ForNeighbors(const cv::Mat& image, const Visit& visit) {
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      for (const auto& [dx, dy] : kNeighbors) {
        const int nx = x + dx, ny = y + dy;
        if (nx >= 0 && nx < image.cols && ny < image.rows) visit(x, y, nx, ny);
      }
}

cv::Mat Cut(const cv::Mat& lab, const cv::Mat& odds) {
  double sum = 0;
  size_t pairs = 0;
  ForNeighbors(lab, [&](int x, int y, int nx, int ny) {
    sum += SquaredContrast(lab, x, y, nx, ny);
    ++pairs;
  });
  const double beta = 1 / std::max(2 * sum / static_cast<double>(std::max<size_t>(1, pairs)), 1e-6);
  const int num_nodes = static_cast<int>(lab.total());
  cv::detail::GCGraph<float> graph(num_nodes, static_cast<int>(2 * pairs));
  for (int i = 0; i < num_nodes; ++i) {
    const float o = odds.at<float>(i / lab.cols, i % lab.cols);
    graph.addTermWeights(graph.addVtx(), std::max(0.f, o), std::max(0.f, -o));
  }
  ForNeighbors(lab, [&](int x, int y, int nx, int ny) {
    const double length = std::hypot(nx - x, ny - y);
    const double cost = (kMinEdge + kEdge * std::exp(-beta * SquaredContrast(lab, x, y, nx, ny))) / length;
    graph.addEdges(y * lab.cols + x, ny * lab.cols + nx, static_cast<float>(cost), static_cast<float>(cost));
  });
  graph.maxFlow();
  cv::Mat mask(lab.size(), CV_8U);
  for (int i = 0; i < num_nodes; ++i) mask.at<uint8_t>(i / lab.cols, i % lab.cols) = graph.inSourceSegment(i) ? 255 : 0;
  return mask;
}

// The object's odds: colours, what is expected, sparse points, and what is sure.
cv::Mat Odds(const SegmentInput& in, const cv::Mat& colors) {
  cv::Mat odds = colors.clone();
  for (int y = 0; y < odds.rows; ++y)
    for (int x = 0; x < odds.cols; ++x) {
      const double d = in.prior.at<float>(y, x);
      const double off = std::max(0.0, d) / in.reach;
      double o = odds.at<float>(y, x) - kPriorEvidence * off * off + kHintEvidence * in.hints.at<int8_t>(y, x);
      if (d > in.reach) o = -kSure;
      if (d < -in.core) o = kSure;
      odds.at<float>(y, x) = static_cast<float>(o);
    }
  return odds;
}

// The same where all but the core is known and in the core only what is near.
cv::Mat CoreOdds(const SegmentInput& in, const cv::Mat& object, const cv::Mat& colors) {
  cv::Mat odds = colors.clone();
  for (int y = 0; y < odds.rows; ++y)
    for (int x = 0; x < odds.cols; ++x) {
      const bool core = in.prior.at<float>(y, x) < -in.core;
      float& o = odds.at<float>(y, x);
      if (!core) o = static_cast<float>(object.at<uint8_t>(y, x) ? kSure : -kSure);
      if (core && in.near.at<uint8_t>(y, x)) o = static_cast<float>(kSure);
    }
  return odds;
}

// What of the core is not the object after all: the colours of the object are learned near and around it alone.
cv::Mat Through(const SegmentInput& in, const cv::Mat& object, const cv::Mat& quiet, const cv::Mat& labels) {
  const cv::Mat core = in.prior < -in.core, open = core & ~in.near;
  cv::Mat known(labels.size(), CV_8U, cv::Scalar(kSurroundings)), mask(labels.size(), CV_8U, cv::Scalar(255));
  known.setTo(kObject, object);
  known.setTo(kUnknown, open);
  if (cv::countNonZero(open) == 0) return core & ~mask;
  for (int round = 0; round < kCoreRounds; ++round) {
    if (round > 0) known.setTo(kObject, mask), known.setTo(kSurroundings, ~mask);
    mask = Cut(quiet, CoreOdds(in, object, ColorEvidence(labels, known)));
  }
  return core & ~mask;
}

}  // namespace

Segmentation Segment(const SegmentInput& input) {
  const cv::Mat lab = ToLab(input.image);
  cv::Mat quiet;
  cv::GaussianBlur(lab, quiet, cv::Size(), 0.8);
  const cv::Mat labels = ColorLabels(quiet);
  cv::Mat known(labels.size(), CV_8U, cv::Scalar(kUnknown)), mask;
  for (int round = 0; round < kRounds; ++round) {
    // At first what is sure, or nearly; then what was found, away from its outline.
    for (int y = 0; y < known.rows; ++y)
      for (int x = 0; x < known.cols; ++x) {
        const double d = input.prior.at<float>(y, x);
        uint8_t& k = known.at<uint8_t>(y, x);
        if (round > 0) k = mask.at<uint8_t>(y, x) ? kObject : kSurroundings;
        if (round == 0) k = d < -0.3 * input.core ? kObject : d > 0.6 * input.reach ? kSurroundings : kUnknown;
      }
    mask = Cut(quiet, Odds(input, ColorEvidence(labels, known)));
  }
  return {mask, Through(input, mask, quiet, labels)};
}

}  // namespace glint::internal
