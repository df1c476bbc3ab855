// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_config.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "core/geo/frames.h"
#include "io/survey/camera_checks.h"
#include "io/text/line_reader.h"

namespace swath::calib {
namespace {

/// `dimension` none: a bare number. In SI.
double sigma_from(const std::string& text, core::Dimension dimension, const std::string& key, const std::string& file) {
  if (text == "held") return held_value;
  if (text == "free") return free_value;
  std::string fault;
  double value = 0.0;
  if (dimension == core::Dimension::none) {
    if (!io::read_number(text, value)) fault = "not a number";
  } else {
    value = core::parse_quantity(dimension, text, fault).value_or(0.0);
  }
  if (fault.empty() && !(value > 0.0 && std::isfinite(value))) fault = "not above 0";
  if (!fault.empty())
    throw core::usage_error("camera.sigma." + key + " is \"" + text + "\": " + fault, file, "\"held\", \"free\", or a sigma");
  return value;
}

}  // namespace

void expect_distances(const core::Value& given, std::vector<core::Fault>& faults) {
  const core::Value* cameras = given.find("camera");
  if (!cameras || !cameras->is_array()) return;
  for (size_t i = 0; i < cameras->items().size(); ++i) io::expect_distance(given, i, faults);
}

BlockConfig read_block_config(const std::filesystem::path& file, const core::Value& given) {
  BlockConfig out;
  std::vector<core::Fault> faults;
  core::read_options(core::described(out), given, "", faults);
  expect_distances(given, faults);
  core::throw_if_any(faults);
  const auto beside = [&](std::filesystem::path& path) {
    if (!path.empty() && path.is_relative()) path = file.parent_path() / path;
  };
  beside(out.images.file);
  beside(out.images.correlation);
  for (io::ImageFile& f : out.image_points) beside(f.file);
  for (BlockControlFile& f : out.control) beside(f.file);
  return out;
}

Eigen::Matrix3d camera_mounting(core::Radians mount, const std::array<core::Radians, 3>& boresight) {
  Eigen::Matrix3d mounted;  // the image's x axis forward, its upper edge to the left
  mounted << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  return core::matrix_of({boresight[0].value, boresight[1].value, boresight[2].value}) *
         Eigen::AngleAxisd(mount.value, Eigen::Vector3d::UnitZ()).toRotationMatrix() * mounted;
}

CameraConfig config_of(const io::SurveyCamera& c) {
  CameraConfig out;
  static_cast<core::FrameCamera&>(out) = c;
  static_cast<core::CameraSigmas&>(out.sigma) = c.sigma;
  out.sigma.antenna = c.sigma.lever_arm;
  out.of_survey = c;
  return out;
}

BlockCamera camera_of(const CameraConfig& c, const std::string& file) {
  constexpr double millimetres = 1e3;
  BlockCamera out;
  out.name = c.name;
  out.value << millimetres * c.f.value, millimetres * c.x0.value, millimetres * c.y0.value, c.k1, c.k2, c.k3, c.p1, c.p2, c.b1, c.b2;
  const std::array<const std::string*, camera_values> sigmas{&c.sigma.f,  &c.sigma.x0, &c.sigma.y0, &c.sigma.k1, &c.sigma.k2,
                                                             &c.sigma.k3, &c.sigma.p1, &c.sigma.p2, &c.sigma.b1, &c.sigma.b2};
  for (size_t k = 0; k < sigmas.size(); ++k) {
    const bool length = k < 3;
    out.sigma[static_cast<Eigen::Index>(k)] =
        (length ? millimetres : 1.0) *
        sigma_from(*sigmas[k], length ? core::Dimension::length : core::Dimension::none, std::string(camera_keys[k]), file);
  }
  if (core::lacks_distortion(c, c.sigma))
    throw core::usage_error("camera " + c.name + ": " + core::distortion_fault, file, core::distortion_hint);
  out.distortion = c.distortion.value_or(DistortionAt::ideal);
  out.body_R_camera = camera_mounting(c.mount, c.boresight);
  out.boresight_sigma.setConstant(sigma_from(c.sigma.boresight, core::Dimension::angle, "boresight", file));
  out.antenna = out.body_R_camera.transpose() * Eigen::Vector3d(c.antenna[0].value, c.antenna[1].value, c.antenna[2].value);
  out.antenna_sigma.setConstant(sigma_from(c.sigma.antenna, core::Dimension::length, c.of_survey ? "lever_arm" : "antenna", file));
  return out;
}

}  // namespace swath::calib
