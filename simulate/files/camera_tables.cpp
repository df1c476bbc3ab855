// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/camera_tables.h"

#include <algorithm>

#include "simulate/random.h"

namespace swath::simulate {
namespace {

constexpr std::uint64_t of_mounting = std::uint64_t{1} << 43;

std::string stated_sigma(core::Dimension dimension, double sigma) { return sigma > 0.0 ? core::format_quantity(dimension, sigma) : "held"; }

io::SurveyCamera stated_camera(const Options& o) {
  const CameraOptions& c = o.camera;
  Random random = random_of(o.seed, Stream::camera, of_mounting);
  const double noise = o.noise.noise_free ? 0.0 : 1.0;
  io::SurveyCamera out;
  out.f = c.nominal_f, out.k3 = c.k3;
  out.distortion = core::DistortionAt::ideal;
  out.columns = c.columns, out.rows = c.rows, out.pixel = c.pixel, out.mount = c.mount;
  out.boresight = c.boresight, out.lever_arm = c.lever_arm;
  for (core::Radians& angle : out.boresight) angle.value += noise * c.boresight_sigma.value * random.normal();
  for (core::Metres& part : out.lever_arm) part.value += noise * c.lever_arm_sigma.value * random.normal();
  out.technique = "marks";
  for (std::string* free : {&out.sigma.f, &out.sigma.x0, &out.sigma.y0, &out.sigma.k1, &out.sigma.k2, &out.sigma.p1, &out.sigma.p2})
    *free = "free";
  out.sigma.boresight = stated_sigma(core::Dimension::angle, c.boresight_sigma.value);
  out.sigma.lever_arm = stated_sigma(core::Dimension::length, c.lever_arm_sigma.value);
  return out;
}

}  // namespace

void describe_camera(const Options& o, const CameraMade& made, io::Survey& survey) {
  survey.cameras = {stated_camera(o)};
  io::ImageFile points;
  points.file = "image_points.csv";
  points.unit = io::ImageUnit::pixel, points.y = io::ImageY::down, points.origin = io::ImageOrigin::corner;
  points.sigma_pixels = std::max(o.camera.noise, 1e-3);
  survey.image_points = {points};
  if (o.camera.photos) {
    survey.photos.emplace_back();
    survey.photos.back().folder = "photos";
  }
  for (const bool check : {false, true}) {
    if (!(check ? made.has_check : made.has_control)) continue;
    io::ControlFile f;
    f.file = check ? "block_check.csv" : "block_control.csv";
    f.use = check ? io::ControlUse::check : io::ControlUse::control;
    f.sigma_horizontal = f.sigma_vertical = core::Metres(std::max(o.camera.control_sigma.value, 1e-4));
    survey.control.push_back(f);
  }
}

}  // namespace swath::simulate
