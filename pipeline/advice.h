// What a run's numbers mean to the person who took the photographs: plain sentences, made from the data alone.
#pragma once

#include <string>
#include <vector>

#include "colmap/scene.h"
#include "constraints/contact.h"
#include "geometry/triangle_mesh.h"
#include "light/light.h"
#include "pipeline/run.h"

namespace glint {

enum class AdviceLevel { kProblem, kWarning, kNote, kGood };

struct Advice {
  AdviceLevel level;
  std::string finding;  // what is the case, with its numbers
  std::string cure;     // what to do about it; may be empty
};

// Most serious first. `mesh` and `contacts` are empty where the run gave up. Never empty: a run of which there is
// nothing to complain says so.
std::vector<Advice> GiveAdvice(const RunSummary& summary, const Scene& scene, const std::vector<Contact>& contacts,
                               const std::vector<Light>& lights, const TriangleMesh& mesh);

}  // namespace glint
