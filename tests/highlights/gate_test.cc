#include "highlights/gate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "highlights/exposure.h"
#include "io/project_images.h"
#include "rendered_scene.h"

namespace glint {
namespace {

using testing::Candidates;
using testing::Photographs;
using testing::SmallScene;

struct Outcome {
  size_t expected = 0, met = 0, accepted = 0, wrong = 0, repeated = 0;
};

// Against the true peaks: lit, not faint, incidence below the limit; a match is within a fifth of the blob's diameter.
Outcome Gated(const SyntheticImageSource& source, const std::vector<cv::Mat>& images) {
  const Scene scene = MakeScene(source.scene().model);
  std::vector<Highlight> highlights = Candidates(images);
  GateHighlights(scene, MemoryImages(images), TrueMesh(source.scene(), 40), source.scene().lights, {}, highlights);
  Outcome outcome;
  std::vector<std::vector<char>> met(images.size());
  for (size_t v = 0; v < images.size(); ++v) met[v].resize(source.Truth(v).highlights.size());
  for (const Highlight& h : highlights) {
    if (h.status != HighlightStatus::kAccepted) continue;
    ++outcome.accepted;
    const auto& truth = source.Truth(h.view).highlights;
    bool right = false;
    for (size_t t = 0; t < truth.size(); ++t) {
      const double reach = std::max(2.0, 0.4 * std::sqrt(h.area_px / M_PI));
      if ((truth[t].px - h.px).norm() >= reach) continue;
      outcome.repeated += met[h.view][t];
      met[h.view][t] = 1;
      right = true;
    }
    outcome.wrong += !right;
  }
  for (size_t v = 0; v < images.size(); ++v)
    for (size_t t = 0; t < met[v].size(); ++t) {
      const TrueHighlight& truth = source.Truth(v).highlights[t];
      const double cos = truth.normal.dot((scene.views[v].Center() - truth.position).normalized());
      if (!truth.lit || truth.strength < 0.1 || cos < std::cos(55 * M_PI / 180)) continue;
      ++outcome.expected;
      outcome.met += met[v][t];
    }
  return outcome;
}

class GateOfGloss : public ::testing::TestWithParam<double> {};

TEST_P(GateOfGloss, KeepsHighlightsAndDropsPaint) {
  SyntheticOptions options = SmallScene("distant", 1);
  options.roughness = GetParam();
  const SyntheticImageSource source(SynthesizeScene(options));
  const Outcome outcome = Gated(source, Photographs(source));
  ASSERT_GE(outcome.expected, 8u);
  // Of broad lobes a mark beside the peak spoils some.
  const bool broad = GetParam() > 0.1;
  EXPECT_GE(outcome.met, (broad ? 0.5 : 0.85) * outcome.expected);
  EXPECT_LE(outcome.wrong, (broad ? 0.3 : 0.1) * outcome.accepted);
}

INSTANTIATE_TEST_SUITE_P(Roughness, GateOfGloss, ::testing::Values(0.05, 0.2),
                         [](const auto& alpha) { return alpha.param < 0.1 ? "Sharp" : "Broad"; });

// Shading makes a lobe on white paint rise more at coarser scales, where it is found again.
TEST(Gate, KeepsOneFindOfEachLobe) {
  SyntheticOptions options = SmallScene("distant", 1);
  options.base = "white";
  options.roughness = 0.1;
  const SyntheticImageSource source(SynthesizeScene(options));
  const Outcome outcome = Gated(source, Photographs(source));
  EXPECT_GE(outcome.met, 0.7 * outcome.expected);
  EXPECT_EQ(outcome.repeated, 0u);
}

// sRGB code values of a linear gain.
void Expose(cv::Mat& image, double gain) {
  cv::Mat table(1, 256, CV_8U);
  for (int code = 0; code < 256; ++code) {
    const double c = code / 255.0;
    const double linear = gain * (c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    const double out = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    table.at<uint8_t>(code) = cv::saturate_cast<uint8_t>(255 * out);
  }
  cv::LUT(image, table, image);
}

TEST(Exposure, DifferencesAreFoundAndDoNotMatter) {
  const SyntheticImageSource source(SynthesizeScene(SmallScene("distant", 1)));
  const Scene scene = MakeScene(source.scene().model);
  std::vector<cv::Mat> images = Photographs(source);
  const auto exposures = [&] {
    const MemoryImages memory(images);
    return RelativeExposures(scene, ViewBrightness(memory, size_t{1} << 28, Progress::Silent()));
  };
  for (double e : exposures()) EXPECT_EQ(e, 1);
  const Outcome before = Gated(source, images);
  for (size_t v = 0; v < images.size(); v += 3) Expose(images[v], 0.4);
  const std::vector<double> changed = exposures();
  // Shading differs from view to view by as much.
  for (size_t v = 0; v < images.size(); ++v) EXPECT_NEAR(std::log(changed[v]), v % 3 == 0 ? std::log(0.4) : 0, 0.3);
  const Outcome after = Gated(source, images);
  EXPECT_GE(after.met + 1, before.met);
  EXPECT_LE(after.wrong, before.wrong + 1);
}

}  // namespace
}  // namespace glint
