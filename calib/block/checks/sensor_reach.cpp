// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/sensor_reach.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "core/error.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

/// Of half the sensor, by 98 % of the points: single blunders are the adjustment's.
constexpr double beyond = 1.05;
/// Points that lie together are in another unit; up to a few tenths only where another unit spreads them over the sensor.
constexpr double together = 0.02, close = 0.3;

struct Sensor {
  double half_x = 0.0, half_y = 0.0, side = 0.0;  ///< mm
};

double reach_of(const std::vector<double>& values, double factor, double shift) {
  constexpr double most = 0.98;
  std::vector<double> sizes;
  sizes.reserve(values.size());
  for (const double v : values) sizes.push_back(std::abs(factor * v + shift));
  return core::quantile(sizes, most);
}

struct Reading {
  std::string what, hint;
};

/// What would put the points on the sensor: x and y as the file was read, mm.
std::optional<Reading> explained(const io::ImageFile& f, const Sensor& s, const std::vector<double>& x, const std::vector<double>& y) {
  const double wide_x = reach_of(x, 1.0, -core::median(x, 0.0)) / s.half_x, wide_y = reach_of(y, 1.0, -core::median(y, 0.0)) / s.half_y;
  const auto fits = [&](double factor, double shift_x, double shift_y) {
    return factor * std::min(wide_x, wide_y) > close && reach_of(x, factor, shift_x) < beyond * s.half_x &&
           reach_of(y, factor, shift_y) < beyond * s.half_y;
  };
  if (!f.unit || !f.origin || !f.y) return {};
  const bool middle = *f.origin == io::ImageOrigin::middle;
  const double up = *f.y == io::ImageY::up ? 1.0 : -1.0;  // from the corner to the middle
  if (middle && fits(1.0, -s.half_x, -up * s.half_y))
    return Reading{"the image points count from a corner of the sensor, not from its middle",
                   "state origin = \"corner\" or \"pixel_centre\""};
  if (!middle && fits(1.0, s.half_x, up * s.half_y))
    return Reading{"the image points count from the middle of the sensor, not from a corner", "state origin = \"middle\""};
  const std::array<double, 3> length{1.0, 1e-3, s.side};  // of a unit, mm; by ImageUnit
  const auto stated = static_cast<size_t>(*f.unit);
  for (size_t unit = 0; unit < length.size(); ++unit) {
    const double factor = length[unit] / length[stated], shift = middle ? 0.0 : factor - 1.0;
    if (unit == stated || !fits(factor, shift * s.half_x, shift * up * s.half_y)) continue;
    const std::string name(core::Choices<io::ImageUnit>::names[unit]);
    return Reading{"the image points are in " + name + ", not in " + std::string(core::Choices<io::ImageUnit>::names[stated]),
                   "state unit = \"" + name + "\""};
  }
  return {};
}

std::string reach_text(const std::string& camera, double far_x, double far_y, const Sensor& s) {
  char text[200];
  std::snprintf(text, sizeof text,
                "image points of camera %s reach %.4g mm in x and %.4g mm in y from the middle, the sensor %.4g mm and %.4g mm",
                camera.c_str(), far_x, far_y, s.half_x, s.half_y);
  return text;
}

}  // namespace

void refuse_off_sensor(const ReadBlock& read, const BlockConfig& config) {
  constexpr size_t enough = 20;
  for (std::uint32_t c = 0; c < config.cameras.size(); ++c) {
    const CameraConfig& camera = config.cameras[c];
    if (!camera.pixel || camera.columns <= 0 || camera.rows <= 0) continue;
    std::vector<double> x, y;
    for (const ImageRay& r : read.block.rays)
      if (read.block.images[r.image].camera == c) x.push_back(r.x), y.push_back(r.y);
    if (x.size() < enough) continue;
    const double side = 1e3 * camera.pixel->value;
    const Sensor s{side * camera.columns / 2.0, side * camera.rows / 2.0, side};
    const double far_x = reach_of(x, 1.0, 0.0), far_y = reach_of(y, 1.0, 0.0);
    const double wide = std::max(reach_of(x, 1.0, -core::median(x, 0.0)) / s.half_x, reach_of(y, 1.0, -core::median(y, 0.0)) / s.half_y);
    const bool off = far_x > beyond * s.half_x || far_y > beyond * s.half_y;
    if (!off && wide > close) continue;
    const std::string reach = reach_text(camera.name, far_x, far_y, s), place = config.image_points.front().file.string();
    if (const auto reading = explained(config.image_points.front(), s, x, y))
      throw core::Error(reading->what + ": " + reach + " as stated", place, reading->hint);
    if (off || wide < together)
      throw core::Error(reach, place,
                        off ? "check unit, origin and pixel, and that columns and rows are not exchanged" : "check unit and pixel");
  }
}

}  // namespace swath::calib
