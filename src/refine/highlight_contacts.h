// All contacts of a reconstruction with their lights, as they follow the surface from step to step. In units of the
// object's diagonal.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "constraints/contact.h"
#include "geometry/ray_caster.h"
#include "geometry/triangle_mesh.h"
#include "light/light.h"
#include "refine/bundle.h"
#include "refine/lobe.h"
#include "refine/surface_constraints.h"
#include "sdf/level_set.h"

namespace glint {

class HighlightContacts {
 public:
  // `solve_lights`: a light each, whether the bundle may move it. `use_lobes`: the sizes of the highlights, too.
  HighlightContacts(std::vector<Contact> contacts, std::vector<Light> lights, std::vector<bool> solve_lights,
                    bool use_lobes);

  const std::vector<Contact>& contacts() const { return contacts_; }
  const std::vector<Light>& lights() const { return lights_; }

  // Lays the rays on the surface (`field`: its signed distances), measures the blobs there and solves the bundle.
  // `reliable_normals`: a seed's are not, those of a surface that has met the contacts once are. Returns how far the
  // contacts moved (median), on the surface or in the bundle, whichever is more.
  double Follow(const TriangleMesh& surface, const LevelSet& field, bool reliable_normals, double max_incidence,
                const std::vector<SurfacePoint>& points, const BundleOptions& options, BundleSummary& summary);
  int num_on_surface() const { return num_on_surface_; }  // when it was last followed

  // What the accepted ones say of the surface: normals and positions at the peaks, normals at the ends of the blobs.
  std::vector<OrientedPoint> Oriented() const;

 private:
  std::vector<double> LayOn(const RayCaster& caster, const LevelSet& field, bool reliable_normals,
                            double max_incidence);
  void MeasureLobes(const TriangleMesh& surface, const RayCaster& caster);
  void AddLobes(std::vector<OrientedPoint>& oriented) const;

  std::vector<Contact> contacts_;
  std::vector<Light> lights_;
  const std::vector<Light> known_lights_;
  const std::vector<bool> solve_lights_;
  const bool use_lobes_;
  int num_on_surface_ = 0;
  std::vector<uint8_t> misfit_;             // a contact: was left out for its size
  std::vector<double> curvature_;           // of the surface at a contact, the largest
  std::vector<std::optional<Lobe>> lobes_;  // a contact: its blob on the current surface
  double lobe_width_ = 0;                   // radians, the median
};

}  // namespace glint
