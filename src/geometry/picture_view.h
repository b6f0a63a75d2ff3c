// A pinhole view for pictures, and how surfaces look in it.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "geometry/rigid.h"

namespace glint {

// The camera looks along its +z axis, x to the right, y down; the centre of the first pixel is at (0.5, 0.5), and the
// optical axis goes through the middle of the picture.
struct PictureView {
  int width = 800;
  int height = 600;
  double focal_px = 1000;
  Rigid3d cam_from_world;

  Eigen::Vector3d CenterInWorld() const { return cam_from_world.Inverse().translation; }
  Eigen::Vector3d DirectionInWorld(double x_px, double y_px) const;  // unit
};

// A view of the whole box from outside, looking along `direction`, with `up` upwards.
PictureView ViewOfBox(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& direction, const Eigen::Vector3d& up,
                      int width, int height);

struct Look {
  std::array<uint8_t, 3> color = {196, 188, 176};     // sRGB, of surfaces without colours of their own
  std::array<uint8_t, 3> back_color = {150, 70, 60};  // seen from behind
  std::array<uint8_t, 3> background = {255, 255, 255};
  int samples_a_side = 2;  // n² rays a pixel
};

// What a ray sees: the surface's unit normal (facing the camera or not) and its sRGB colour.
struct Seen {
  Eigen::Vector3d normal;
  std::array<uint8_t, 3> color;
  double open = 1;  // the share of the sky that is not hidden
};

// Linear RGB of a matt surface with a faint gloss under a key light from the upper left, a fill light and sky.
Eigen::Vector3d Shade(const PictureView& view, const Look& look, const Eigen::Vector3d& direction, const Seen& seen);

// Averages the rays of all pixels into sRGB, three bytes a pixel, rows from the top. `trace(x, y)` gives the linear RGB
// of the ray through picture point (x, y), and is called from several threads.
std::vector<uint8_t> RenderPixels(const PictureView& view, const Look& look,
                                  const std::function<Eigen::Vector3d(double x_px, double y_px)>& trace);

Eigen::Vector3d LinearFromSrgb(const std::array<uint8_t, 3>& color);

}  // namespace glint
