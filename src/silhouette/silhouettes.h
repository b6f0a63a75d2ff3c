// The object's outlines, from masks or found in the photographs, as far as the views confirm each other.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "colmap/scene.h"
#include "core/options.h"
#include "core/progress.h"
#include "geometry/triangle_mesh.h"
#include "io/image_source.h"
#include "silhouette/outline.h"

namespace glint {

struct SilhouetteOptions {
  std::string use = "auto";
  int max_views = 60;

  void Visit(OptionVisitor& v);
};

// What is known of the object before.
struct RoughObject {
  const TriangleMesh& mesh;                                 // closed
  std::vector<int8_t> point_side;                           // per scene point: 1 the object's, -1 not, 0 unknown
  std::optional<Eigen::Hyperplane<double, 3>> ground = {};  // the object stands on its positive side
};

struct SilhouetteSummary {
  std::string source;  // "masks", "photographs"; empty: not looked for
  size_t num_views = 0;
  size_t num_trusted_views = 0;
  size_t num_samples = 0;
  size_t num_trusted_samples = 0;

  std::string BriefReport() const;
};

// Thread-safe.
class Silhouettes {
 public:
  Silhouettes();
  ~Silhouettes();
  Silhouettes(Silhouettes&&) noexcept;
  Silhouettes& operator=(Silhouettes&&) noexcept;

  // Empty where the views do not confirm each other.
  const std::vector<OutlineSample>& outline() const;
  // The outline and what else touches the object, though from few sides where along its ray is uncertain.
  const std::vector<OutlineSample>& rays() const;

  // How far x is outside of the object by what several trusted views agree on, world units; negative: inside all
  // outlines but at most a few. Nothing where too few views see it.
  std::optional<double> OutsideBy(const Eigen::Vector3d& x) const;

  // How deep x is in holes of the outlines of at least so many views, world units; negative: not in so many. Nothing
  // where fewer have any.
  std::optional<double> SeenThroughBy(const Eigen::Vector3d& x, size_t views) const;
  size_t num_views() const;  // trusted ones

  // Whether most places on the outline have no other view's beside them.
  bool from_few_sides() const { return rays().size() > 2 * outline().size(); }
  // From few sides: what nearly all trusted views leave room for, above the ground, coarsely. Empty otherwise.
  const TriangleMesh& hull() const;

 private:
  friend Silhouettes FindSilhouettes(const Scene&, const ImageSource&, const RoughObject&, const SilhouetteOptions&,
                                     SilhouetteSummary*, Progress&);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Masks are used where they show the object: the rough mesh fills them. Otherwise each photograph is segmented (graph
// cut; colours around inside and outside of the rough mesh's projection, edges, sparse points of either side). Each
// sample of an outline is then judged by the *other* views: their masks must leave room for the surface just inside
// its ray and none well outside of it. Views most of whose samples fail are left out; if most views are, nothing is
// kept. Found outlines also need an edge in the photograph.
Silhouettes FindSilhouettes(const Scene& scene, const ImageSource& images, const RoughObject& rough,
                            const SilhouetteOptions& options = {}, SilhouetteSummary* summary = nullptr,
                            Progress& progress = Progress::Silent());

}  // namespace glint
