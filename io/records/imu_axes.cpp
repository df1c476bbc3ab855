// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/imu_axes.h"

#include <Eigen/LU>
#include <string>

#include "core/error.h"
#include "core/geo/frames.h"

namespace swath::io {

double mps2_per(AccelerationUnit unit) {
  constexpr double g = 9.80665;  // standard gravity, by definition
  switch (unit) {
    case AccelerationUnit::unstated:
      return 0.0;
    case AccelerationUnit::mps2:
      return 1.0;
    case AccelerationUnit::g:
      return g;
    case AccelerationUnit::mg:
      return 1e-3 * g;
  }
  return 0.0;
}

Eigen::Matrix3d body_R_record(const ImuFile& f) {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
  for (size_t row = 0; row < 3; ++row) {
    const std::string& axis = f.axes[row];
    const std::string letter = !axis.empty() && axis[0] == '-' ? axis.substr(1) : axis;
    const size_t column = std::string("xyz").find(letter);
    if (letter.size() != 1 || column == std::string::npos)
      throw core::usage_error("'" + axis + "' is no axis", f.file.string(), "axes are x, y, z, -x, -y and -z");
    axes(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) = axis == letter ? 1 : -1;
  }
  const double turn = axes.determinant();
  const std::string list = "\"" + f.axes[0] + "\", \"" + f.axes[1] + "\", \"" + f.axes[2] + "\"";
  if (turn == 0) throw core::usage_error("axes = [" + list + "] name one axis twice", f.file.string(), "each of x, y and z stands once");
  if (turn < 0)
    throw core::usage_error("axes = [" + list + "] are left-handed", f.file.string(),
                            "forward, right and down are right-handed: change the sign of one axis or swap two");
  return core::matrix_of({f.roll.value, f.pitch.value, f.heading.value}) * axes;
}

}  // namespace swath::io
