// What the highlights of lights have in common, seen on the seed.
#pragma once

#include <optional>
#include <vector>

namespace glint {

struct SeenOnSeed {
  int light = 0;
  double off_deg = 0;  // half vector against the seed's normal where the ray meets it
  // By how much the normal turns from the peak to half its height (mirror_test.h); nullopt: not known.
  std::optional<double> width_deg;
};

enum class Unlike { kNo, kNormal, kWidth };

// Which of the things that passed for highlights are unlike the others. Where the seed is good, marks of
// paint near the mirror point are as far off as chance has it: the angles are a mixture of the seed's errors (normal
// in two dimensions) and of directions that are spread evenly. And one gloss makes lobes of one width, which what is
// much narrower does not share (what is much wider may be the lobe, where many marks are narrow). Of few all are kept.
std::vector<Unlike> FindUnlike(const std::vector<SeenOnSeed>& seen, int num_lights);

}  // namespace glint
