#include "tests/fuzz/targets.h"

namespace glint::fuzz {

const std::vector<Target>& Targets() {
  static const std::vector<Target> targets = [] {
    std::vector<Target> all;
    for (const auto& group : {ColmapTargets(), MeshTargets(), ImageTargets(), TextTargets()})
      all.insert(all.end(), group.begin(), group.end());
    return all;
  }();
  return targets;
}

const Target* FindTarget(std::string_view name) {
  for (const Target& target : Targets())
    if (target.name == name) return &target;
  return nullptr;
}

}  // namespace glint::fuzz
