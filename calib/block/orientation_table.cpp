// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/orientation_table.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "core/config/units.h"
#include "core/printable.h"

namespace swath::calib {
namespace {

std::string table_field(const char* form, double value) {
  char text[48];
  std::snprintf(text, sizeof text, form, value);
  return text;
}

}  // namespace

Eigen::Vector3d omega_phi_kappa_of(const Eigen::Matrix3d& R) {
  return {std::atan2(-R(1, 2), R(2, 2)), std::asin(std::clamp(R(0, 2), -1.0, 1.0)), std::atan2(-R(0, 1), R(0, 0))};
}

Eigen::Matrix3d matrix_of_omega_phi_kappa(const Eigen::Vector3d& a) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  return (AngleAxisd(a[0], Vector3d::UnitX()) * AngleAxisd(a[1], Vector3d::UnitY()) * AngleAxisd(a[2], Vector3d::UnitZ()))
      .toRotationMatrix();
}

int plan_decimals(const Eigen::Vector3d& map) {
  const bool degrees = std::abs(map.x()) <= 360.0 && std::abs(map.y()) <= 90.0;  // more decimals do no harm where they are metres
  return degrees ? 10 : 4;
}

std::string crs_of_comment(const std::string& text) {
  constexpr std::string_view key = "crs:";
  if (!text.starts_with(key)) return {};
  const size_t begin = text.find_first_not_of(' ', key.size()), end = text.find(';');
  return begin < end ? text.substr(begin, end - begin) : "";
}

std::string orientation_header(const std::string& crs) {
  std::string out =
      "# crs: " + crs +
      "; omega phi kappa, deg: grid_R_camera = Rx(omega) Ry(phi) Rz(kappa), camera x right, y up, z backward; r11 to r33: the "
      "same matrix by rows\n# roll pitch heading, deg: of the body, from true north; c11 to c66: covariance of east, north, "
      "up (m) and of rotations about the camera's x, y, z (rad)\n"
      "image,camera,strip,x,y,z,omega,phi,kappa,roll,pitch,heading";
  for (int r = 1; r <= 3; ++r)
    for (int c = 1; c <= 3; ++c) out += ",r" + std::to_string(r) + std::to_string(c);
  for (int r = 1; r <= 6; ++r)
    for (int c = r; c <= 6; ++c) out += ",c" + std::to_string(r) + std::to_string(c);
  return out + "\n";
}

std::string orientation_line(const std::string& image, const std::string& camera, int strip, const ImageOrientation& o) {
  std::string out = core::csv_field(image) + "," + core::csv_field(camera) + "," + std::to_string(strip);
  const char* const place = plan_decimals(o.map) > 4 ? ",%.10f" : ",%.4f";
  for (int k = 0; k < 2; ++k) out += table_field(place, o.map[k]);
  out += table_field(",%.4f", o.map.z());
  const Eigen::Vector3d angles = omega_phi_kappa_of(o.grid_R_camera);
  for (int k = 0; k < 3; ++k) out += table_field(",%.7f", angles[k] / core::degree);
  for (const double a : {o.attitude.roll, o.attitude.pitch, o.attitude.heading}) out += table_field(",%.7f", a / core::degree);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) out += table_field(",%.12f", o.grid_R_camera(r, c));
  for (int r = 0; r < 6; ++r)
    for (int c = r; c < 6; ++c) out += table_field(",%.6e", o.covariance(r, c));
  return out + "\n";
}

}  // namespace swath::calib
