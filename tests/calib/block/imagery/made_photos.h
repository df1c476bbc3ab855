// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs of a made scene: level ground with a house, each place with a colour of its own.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/block/imagery/oriented_images.h"
#include "calib/block/orientation_table.h"
#include "core/error.h"
#include "io/raster/image_raster.h"
#include "tests/world/support.h"

namespace swath::calib::test {

/// Ground at height 0; a house over 40..60 m east, 40..60 m north, with a flat roof.
struct MadeScene {
  static constexpr double west = 40.0, east = 60.0, south = 40.0, north = 60.0;
  double roof = 12.0;

  bool is_house(double x, double y) const { return roof > 0.0 && x >= west && x < east && y >= south && y < north; }
  double height(double x, double y) const { return is_house(x, y) ? roof : 0.0; }

  /// 8 bits: smooth in the place, so that a pixel's error shows; blue is 200 on the roof, 120 on walls, 40 on the ground.
  static std::array<double, 3> colour(double x, double y, double blue) { return {20.0 + 2.0 * x, 20.0 + 2.0 * y, blue}; }

  /// What a ray from above meets first.
  std::array<double, 3> seen(const Eigen::Vector3d& from, const Eigen::Vector3d& way) const {
    if (roof > 0.0) {
      const double top = (roof - from.z()) / way.z();
      const Eigen::Vector3d p = from + top * way;
      if (is_house(p.x(), p.y())) return colour(p.x(), p.y(), 200.0);
    }
    const double bottom = -from.z() / way.z();
    const Eigen::Vector3d g = from + bottom * way;
    if (roof > 0.0) {  // through a wall on its way to the ground?
      for (double z = roof; z > 0.0; z -= 0.02) {
        const Eigen::Vector3d p = from + (z - from.z()) / way.z() * way;
        if (is_house(p.x(), p.y())) return colour(p.x(), p.y(), 120.0);
      }
    }
    return colour(g.x(), g.y(), 40.0);
  }
};

struct MadePhoto {
  std::string name;
  Eigen::Vector3d place;
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();  ///< omega, phi, kappa, rad
  double sigma = 0.0;                              ///< of each coordinate, m, and ten thousandths of it of angles, rad
};

inline CameraConfig made_camera() {
  CameraConfig c;
  c.name = "small";
  c.f = core::Metres(0.02), c.columns = 240, c.rows = 160, c.pixel = core::Metres(1e-4);  // 24 x 16 mm
  c.x0 = core::Metres(1.5e-4), c.y0 = core::Metres(-2e-4);
  c.k1 = -1e-4, c.p1 = 2e-5;
  c.distortion = DistortionAt::ideal;
  return c;
}

inline Eigen::Matrix3d rotation_of(const Eigen::Vector3d& tilt) {
  using Eigen::AngleAxisd;
  return (AngleAxisd(tilt.x(), Eigen::Vector3d::UnitX()) * AngleAxisd(tilt.y(), Eigen::Vector3d::UnitY()) *
          AngleAxisd(tilt.z(), Eigen::Vector3d::UnitZ()))
      .toRotationMatrix();
}

inline io::ImageRaster photograph(const MadeScene& scene, const MadePhoto& photo, int bits = 8) {
  const CameraConfig config = made_camera();
  const BlockCamera camera = camera_of(config, "made");
  io::ImageRaster out{config.columns, config.rows, 3, bits, {}};
  const double side = 1e3 * config.pixel->value;
  for (int r = 0; r < out.rows; ++r)
    for (int c = 0; c < out.columns; ++c) {
      const Eigen::Vector2d at((c + 0.5 - out.columns / 2.0) * side, (out.rows / 2.0 - r - 0.5) * side);
      const auto way = direction_of(camera.value, camera.distortion, at);
      const auto colour = scene.seen(photo.place, rotation_of(photo.tilt) * *way);
      for (const double v : colour)
        out.values.push_back(static_cast<std::uint16_t>(std::lround((bits == 8 ? 1.0 : 256.0) * std::clamp(v, 0.0, 255.0))));
    }
  return out;
}

inline std::string orientation_row(const MadePhoto& photo) {
  ImageOrientation o;
  o.map = photo.place;
  o.grid_R_camera = rotation_of(photo.tilt);
  o.covariance.diagonal().head<3>().setConstant(photo.sigma * photo.sigma);
  o.covariance.diagonal().tail<3>().setConstant(1e-8 * photo.sigma * photo.sigma);
  return orientation_line(photo.name, "small", 1, o);
}

/// What an error says; empty where there is none.
template <class F>
std::string message_of(const F& f) {
  try {
    f();
  } catch (const core::Error& e) {
    return e.what();
  }
  return {};
}

/// Writes the photographs as TIFF and their table.
class MadePhotos {
 public:
  explicit MadePhotos(const std::vector<MadePhoto>& photos, const MadeScene& scene = {}, int bits = 8) {
    std::string table = orientation_header("local");
    std::filesystem::create_directories(folder() / "photos");
    for (const MadePhoto& p : photos) {
      io::write_image_raster(folder() / "photos" / (p.name + ".tif"), photograph(scene, p, bits));
      table += orientation_row(p);
    }
    swath::test::write_bytes(folder() / "orientation.csv", table);
  }
  std::filesystem::path folder() const { return folder_.path(); }
  PhotoSource source() const { return {folder() / "photos", folder() / "orientation.csv", "", {made_camera()}, "camera.toml"}; }
  OrientedImages read() const { return read_oriented_images({source()}, {}); }

 private:
  swath::test::TemporaryFolder folder_;
};

}  // namespace swath::calib::test
