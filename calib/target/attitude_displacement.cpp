// SPDX-License-Identifier: GPL-3.0-or-later
// Source: A. A. Brandalize, "Perfilamento a laser", eq 5 to 11; eq 9 is printed with its sign turned. The exact geometry: a beam that
// leaves the scanner along v meets the target at M v (M: mounting error), and is computed to be at v. A profile's beam is (0, 0, 1), a wall
// and the swath's edge are met by the beam (0, sin a, cos a) that reaches their y at the target's height.
#include "calib/target/attitude_displacement.h"

#include <Eigen/LU>
#include <cmath>

#include "calib/words.h"

namespace swath::calib {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double pitch_displacement(double along, double z) { return along / z; }                                           // eq 9
double roll_displacement(double across, double z) { return -across / z; }                                         // eq 10
double heading_displacement(double along, double z, double pitch, double y) { return (-along + z * pitch) / y; }  // eq 11

core::Attitude small_angle_displacement(const OpposedDisplacements& d, SideDistance side) {
  core::Attitude a;
  a.pitch = pitch_displacement(d.along_nadir, d.z);
  a.roll = roll_displacement(d.across, d.z);
  a.heading = heading_displacement(d.along_side, d.z, a.pitch, side == SideDistance::computed ? d.y_computed : d.y);
  return a;
}

namespace {

/// The beam (0, vy, vz), unscaled, that meets y at height z.
Vector3d beam_to(const Matrix3d& M, double y, double z) {
  const Eigen::Vector2d v = M.bottomRightCorner<2, 2>().inverse() * Eigen::Vector2d(y, z);
  return {0.0, v.x(), v.y()};
}

}  // namespace

OpposedDisplacements displacements_of(const core::Attitude& mounting_error, double z, double y) {
  const Matrix3d M = core::matrix_of(mounting_error);
  OpposedDisplacements d;
  d.z = z;
  d.y = y;
  d.along_nadir = -z * M(0, 2) / M(2, 2);
  d.across = beam_to(M, 0.0, z).y();
  const Vector3d side = beam_to(M, y, z);
  d.along_side = -(M * side).x();
  d.y_computed = side.y();
  return d;
}

core::Attitude mounting_of(const core::Attitude& d) { return {-d.roll, -d.pitch, -d.heading}; }

core::Attitude inverse(const core::Attitude& a) {
  const core::Attitude i = core::attitude_of(core::matrix_of(a).transpose());
  return {i.roll, i.pitch, core::wrap_pi(i.heading)};
}

core::Attitude small_angle_error(const core::Attitude& displacement, double z, double y, SideDistance side) {
  const core::Attitude formulas = small_angle_displacement(displacements_of(inverse(displacement), z, y), side);
  return {formulas.roll - displacement.roll, formulas.pitch - displacement.pitch, formulas.heading - displacement.heading};
}

std::string small_angle_warning(const core::Attitude& displacement, double z, double y, double most, SideDistance side) {
  const core::Attitude e = small_angle_error(displacement, z, y, side);
  std::string out;
  const auto tell = [&](const char* name, double error) {
    if (std::abs(error) > most) out += words("%s%s by %.2g mrad", out.empty() ? "" : ", ", name, 1e3 * std::abs(error));
  };
  tell("roll", e.roll);
  tell("pitch", e.pitch);
  tell("heading", e.heading);
  return out.empty() ? out : "displacements this large are beyond the small-angle formulas: they err in " + out;
}

}  // namespace swath::calib
