// What is known of the surface at single places, as rows over the voxels of a band (DESIGN 3.4): normals and positions
// of contacts, positions of points, each weighted down where it is an outlier.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "photometry/tilt.h"
#include "refine/band.h"
#include "refine/band_rows.h"
#include "refine/bundle.h"

namespace glint {

// A place where the surface's position and normal are known. Lengths in units of the object's diagonal.
struct OrientedPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // on the current surface: where the normal holds
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  Eigen::Vector3d bundle_position = Eigen::Vector3d::Zero();  // where the bundle has it
  double sigma_position = 0;                                  // of the latter, across the surface; 0: not known
  double sigma_normal = 0;                                    // radians
  int light = -1;
  double sigma_light = 0;  // radians: what an error of the light, which all its contacts share, turns the normal by
  double reach = 0;        // radius within which it explains the surface, so that the seed need not be kept
};

class SurfaceConstraints {
 public:
  // Keeps a reference to the band.
  explicit SurfaceConstraints(const Band& band) : band_(band), row_(band.size()) {}

  // A weight of 0 leaves them out.
  void AddContacts(const std::vector<OrientedPoint>& contacts, double weight);
  void AddPoints(const std::vector<SurfacePoint>& points, double weight);
  void AddOutline(const std::vector<OrientedPoint>& touched, double weight);
  // Their shares lower the weight, but as outliers they are judged one by one.
  void AddTilts(const std::vector<Tilt>& tilts);

  // With the full weight each.
  const BandRows& rows() const { return rows_; }
  int contacts_off_band() const { return contacts_off_band_; }
  int points_off_band() const { return points_off_band_; }

  // A weight a row for the field phi: less the more standard deviations it is off. `trust_contacts`: not of contacts,
  // unless their normals are off by more than any seed's are.
  std::vector<double> RobustWeights(const std::vector<double>& phi, bool trust_contacts) const;

  // Errors of the rows' targets where the lights are off: `off` has a vector of independent standard normals a light.
  std::vector<double> LightNoise(const std::vector<OrientedPoint>& contacts,
                                 const std::vector<Eigen::Vector3d>& off) const;

 private:
  // Rows that are weighted down together.
  struct Group {
    size_t first, last;
    bool is_point;  // or of an outline, or a tilt
    int contact;    // whose normal it is; -1: of no contact
    double share;   // by which its weights are lower than a single measurement's
  };
  void EndGroup(size_t first, bool is_point, int contact = -1, double share = 1);

  const Band& band_;

  RowBuilder row_;
  BandRows rows_;
  std::vector<double> base_weight_;
  std::vector<Group> groups_;
  int contacts_off_band_ = 0, points_off_band_ = 0;
};

}  // namespace glint
