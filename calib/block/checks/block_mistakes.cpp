// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/block_mistakes.h"

#include <algorithm>
#include <array>
#include <map>

#include "calib/block/block_start.h"
#include "calib/block/checks/block_control_checks.h"
#include "core/config/units.h"

namespace swath::calib {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector3d;
using Triple = std::array<double, 3>;

Matrix2d matrix(double a, double b, double c, double d) {
  Matrix2d M;
  M << a, b, c, d;
  return M;
}

void shift_all(ImageBlock& block, int step) {
  std::map<int, char> strips;
  for (const BlockImage& i : block.images) strips[i.strip] = 1;
  for (const auto& [strip, there] : strips) {
    const std::vector<std::uint32_t> images = flown(block, strip);
    if (images.size() < 3) continue;
    const std::vector<Vector3d> next = positions_of_next(block, images, step);
    for (size_t k = 0; k < images.size(); ++k) block.images[images[k]].position = next[k];
  }
}

/// The angles that a table would have, from those that it has.
struct OtherAngles {
  std::string what, hint;
  ImageAngles kind;
  ImageNorth north;
  std::function<Triple(const Triple&)> from;
};

Mistake with_angles(const OtherAngles& o) {
  return {o.what, o.hint, [o](ReadBlock& other) {
            for (const StatedAngles& a : other.angles)
              set_attitude(other.block, a.image, body_attitude(other, a.image, o.from(a.value), o.kind, o.north));
          }};
}

void add_kinds(ImageAngles kind, ImageNorth north, std::vector<Mistake>& out) {
  const auto same = [](const Triple& v) { return v; };
  const auto other = [&](const char* what, const char* name, ImageAngles k) {
    out.push_back(with_angles({what, std::string("state angles = \"") + name + "\"", k, north, same}));
  };
  if (kind != ImageAngles::roll_pitch_heading)
    other("the angles are roll pitch heading of the body, not those of the camera", "roll_pitch_heading", ImageAngles::roll_pitch_heading);
  else {
    other("the angles are omega phi kappa of the camera, not roll pitch heading", "omega_phi_kappa", ImageAngles::omega_phi_kappa);
    other("the angles are phi omega kappa of the camera, not roll pitch heading", "phi_omega_kappa", ImageAngles::phi_omega_kappa);
  }
  if (kind == ImageAngles::omega_phi_kappa)
    other("the angles are phi omega kappa, not omega phi kappa", "phi_omega_kappa", ImageAngles::phi_omega_kappa);
  if (kind == ImageAngles::phi_omega_kappa)
    other("the angles are omega phi kappa, not phi omega kappa", "omega_phi_kappa", ImageAngles::omega_phi_kappa);
}

void add_signs(ImageAngles kind, ImageNorth north, std::vector<Mistake>& out) {
  const std::array<const char*, 3> names =
      kind == ImageAngles::roll_pitch_heading ? std::array{"roll", "pitch", "heading"} : std::array{"omega", "phi", "kappa"};
  for (size_t k = 0; k < 3; ++k)
    out.push_back(
        with_angles({std::string(names[k]) + " has the other sign", "turn the sign of the column", kind, north, [k](const Triple& v) {
                       Triple w = v;
                       w[k] = -w[k];
                       return w;
                     }}));
  out.push_back(with_angles({"all angles have the other sign", "the angles may turn the map to the camera: turn their signs and order",
                             kind, north, [](const Triple& v) {
                               return Triple{-v[0], -v[1], -v[2]};
                             }}));
  out.push_back(with_angles({std::string(names[0]) + " and " + names[1] + " are exchanged", "exchange the names of the two columns", kind,
                             north, [](const Triple& v) {
                               return Triple{v[1], v[0], v[2]};
                             }}));
  out.push_back(with_angles(
      {std::string(names[2]) + " counts counter-clockwise from east", "write 90 deg less the column", kind, north, [](const Triple& v) {
         return Triple{v[0], v[1], core::pi / 2.0 - v[2]};
       }}));
}

void add_turns(ImageNorth north, std::vector<Mistake>& out) {
  for (const auto& [turn, what] : {std::pair{180.0, "by 180 deg"}, {90.0, "by -90 deg"}, {-90.0, "by 90 deg"}})
    out.push_back(
        with_angles({std::string("headings are off ") + what, "headings of the body count clockwise from north: correct the column",
                     ImageAngles::roll_pitch_heading, north, [by = turn * core::degree](const Triple& v) {
                       return Triple{v[0], v[1], v[2] + by};
                     }}));
}

void add_units(ImageAngles kind, ImageNorth north, std::vector<Mistake>& out) {
  for (const auto& [factor, what] :
       {std::pair{1.0 / core::degree, "the angles are in radians, not in degrees"}, {0.9, "the angles are in gon, not in degrees"}})
    out.push_back(with_angles({what, "convert the columns to degrees", kind, north, [f = factor](const Triple& v) {
                                 return Triple{f * v[0], f * v[1], f * v[2]};
                               }}));
}

}  // namespace

const char* const match_by_time = "an event is missing or was counted twice: match images and events by their time";

std::vector<std::uint32_t> flown(const ImageBlock& block, int strip) {
  std::vector<std::uint32_t> images;
  for (std::uint32_t i = 0; i < block.images.size(); ++i)
    if (block.images[i].strip == strip) images.push_back(i);
  std::sort(images.begin(), images.end(), [&](auto a, auto b) { return block.images[a].time < block.images[b].time; });
  return images;
}

std::vector<Vector3d> positions_of_next(const ImageBlock& block, const std::vector<std::uint32_t>& images, int step) {
  const auto at = [&](size_t k) -> const Vector3d& { return block.images[images[k]].position; };
  const size_t n = images.size();
  std::vector<Vector3d> out;
  for (size_t k = 0; k < n; ++k) {
    if (step < 0)
      out.push_back(k == 0 ? Vector3d(2.0 * at(0) - at(1)) : at(k - 1));
    else
      out.push_back(k + 1 == n ? Vector3d(2.0 * at(n - 1) - at(n - 2)) : at(k + 1));
  }
  return out;
}

std::vector<Mistake> mistakes_of_image_axes() {
  const auto axes = [](const std::string& what, const std::string& hint, const Matrix2d& M) {
    return Mistake{what, hint, [M](ReadBlock& read) {
                     for (ImageRay& r : read.block.rays) {
                       const Eigen::Vector2d p = M * Eigen::Vector2d(r.x, r.y);
                       r.x = p.x(), r.y = p.y();
                     }
                   }};
  };
  return {axes("the y axis of the image points has the other sense", "state the other of y = \"up\" and y = \"down\"", matrix(1, 0, 0, -1)),
          axes("the images are mirrored (x has the other sense)",
               "image points of a mirrored scan or of negatives: measure in the positive, or turn the sign of x", matrix(-1, 0, 0, 1)),
          axes("the camera is turned by 180 deg", "add 180 deg to camera.mount", matrix(-1, 0, 0, -1)),
          axes("the camera is turned by 90 deg", "take 90 deg off camera.mount", matrix(0, -1, 1, 0)),
          axes("the camera is turned by 90 deg", "add 90 deg to camera.mount", matrix(0, 1, -1, 0)),
          axes("x and y of the image points are exchanged", "exchange x_column and y_column", matrix(0, 1, 1, 0)),
          axes("the images are mirrored and turned by 90 deg", "state the other of y = \"up\" and y = \"down\", and check camera.mount",
               matrix(0, -1, -1, 0))};
}

std::vector<Mistake> mistakes_of_angles(const ReadBlock& read, const BlockConfig& config) {
  std::vector<Mistake> out;
  const ImageAngles kind = config.images.angles;
  if (kind == ImageAngles::none) return out;
  const ImageNorth north = *config.images.north;
  const bool boresight_held =
      std::all_of(read.block.cameras.begin(), read.block.cameras.end(), [](const BlockCamera& c) { return c.boresight_sigma.isZero(0.0); });
  if (boresight_held)  // an unknown boresight heading is the same to the images
    out.push_back(
        with_angles({"headings (kappa) count from the other north", "state the other of north = \"grid\" and north = \"true\"", kind,
                     north == ImageNorth::grid ? ImageNorth::true_north : ImageNorth::grid, [](const Triple& v) { return v; }}));
  add_kinds(kind, north, out);
  add_signs(kind, north, out);
  add_units(kind, north, out);
  if (kind == ImageAngles::roll_pitch_heading) add_turns(north, out);
  if (!config.images.angles_hint.empty())
    for (Mistake& m : out) m.hint = config.images.angles_hint;
  return out;
}

std::vector<Mistake> mistakes_of_cameras(const ReadBlock& read) {
  constexpr int shape = camera_values - 3;  // k1 to b2
  const auto is_held = [](const BlockCamera& c) {
    return (c.sigma.tail<shape>().array() == held_value).all() && !c.value.tail<shape>().isZero(0.0);
  };
  if (std::none_of(read.block.cameras.begin(), read.block.cameras.end(), is_held)) return {};
  return {{"the distortion has the other sign", "k1 to b2 are measured less ideal: change the signs of the values if they are corrections",
           [is_held](ReadBlock& r) {
             for (BlockCamera& c : r.block.cameras)
               if (is_held(c)) c.value.tail<shape>() *= -1.0;
           }}};
}

std::vector<Mistake> mistakes_of_stations(const ReadBlock& read) {
  if (read.stations_observed == 0) return {};
  return {{"the stations are those of the image before", match_by_time, [](ReadBlock& r) { shift_all(r.block, 1); }},
          {"the stations are those of the image after", match_by_time, [](ReadBlock& r) { shift_all(r.block, -1); }},
          {"heights of the stations are in feet", "convert to metres: 1 ft = 0.3048 m", [](ReadBlock& r) {
             for (BlockImage& i : r.block.images) {
               const Vector3d map = r.frame.map_of(i.position);
               i.position = r.frame.local_of({map.x(), map.y(), foot * map.z()});
             }
           }}};
}

}  // namespace swath::calib
