// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/mount_directions.h"

#include <cmath>
#include <cstdio>
#include <set>

#include "calib/block/checks/block_mistakes.h"
#include "core/config/units.h"
#include "core/geo/frames.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

double heading_of(const Vector3d& direction) { return std::atan2(direction.x(), direction.y()); }

/// By camera: angles from the direction of flight to the body's front, clockwise.
std::vector<std::vector<double>> turns_of(const ImageBlock& b) {
  std::vector<std::vector<double>> out(b.cameras.size());
  std::set<int> strips;
  for (const BlockImage& i : b.images) strips.insert(i.strip);
  for (const int strip : strips) {
    const std::vector<std::uint32_t> images = flown(b, strip);
    for (size_t k = 0; k + 1 < images.size(); ++k) {
      const BlockImage &from = b.images[images[k]], &to = b.images[images[k + 1]];
      const Vector3d way = to.position - from.position,
                     front = (b.cameras[from.camera].body_R_camera * from.camera_R_local).transpose() * Vector3d::UnitX();
      if (way.head<2>().norm() > 0.0) out[from.camera].push_back(core::wrap_pi(heading_of(front) - heading_of(way)));
    }
  }
  return out;
}

std::string sentence(const std::string& camera, double quarter, double mount) {
  char text[300];
  std::snprintf(
      text, sizeof text,
      "camera %s flies with the body's front %+.0f deg from the direction of flight (clockwise): state mount = \"%.0f deg\" where "
      "it did not; roll, pitch, heading, boresight and antenna depend on it",
      camera.c_str(), quarter, mount);
  return text;
}

}  // namespace

std::vector<std::string> mount_findings(const ReadBlock& read, const BlockConfig& config) {
  constexpr double near = 25.0 * core::degree;  // crab, and what a mount is off beside quarters
  constexpr double most = 0.8;                  // of the images: some are of turns
  constexpr size_t enough = 4;
  if (config.images.angles == ImageAngles::roll_pitch_heading || read.started_level || config.images.file.empty()) return {};
  std::vector<std::string> out;
  const auto turns = turns_of(read.block);
  for (size_t c = 0; c < turns.size(); ++c)
    for (const double quarter : {90.0, -90.0, 180.0}) {
      size_t alike = 0;
      for (const double t : turns[c]) alike += std::abs(core::wrap_pi(t - quarter * core::degree)) < near;
      if (turns[c].size() < enough || static_cast<double>(alike) < most * static_cast<double>(turns[c].size())) continue;
      const double mount = core::wrap_pi(config.cameras[c].mount.value + quarter * core::degree) / core::degree;
      out.push_back(sentence(read.block.cameras[c].name, quarter, mount));
    }
  return out;
}

}  // namespace swath::calib
