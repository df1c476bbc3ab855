// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/imu_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "core/statistics.h"
#include "io/records/imu_axes.h"
#include "io/survey/record_times.h"

namespace swath::io {
namespace {

using Eigen::Vector3d;

constexpr double gravity = 9.80665;          // m/s2; normal gravity differs by less than 0.3 % on the ground
constexpr double near_gravity = 0.1;         // mass of a level vehicle: banked turns are a small share of a record
constexpr double sure = 0.15;                // of gravity: a unit that comes as near as this is the right one
constexpr double level = 20.0, side = 45.0;  // deg between the median of the specific force and up
constexpr double fast = 0.15;                // rad/s: a turn at twice the standard rate is 0.1, a car's corner 0.5 but not all the time
constexpr double impossible = 1.0;           // rad/s
constexpr double slow_turn = 0.05 * core::degree;

std::string text(const char* format, double a, double b = 0, double c = 0) {
  std::array<char, 160> out{};
  std::snprintf(out.data(), out.size(), format, a, b, c);  // NOLINT: the formats are the callers' literals
  return out.data();
}

/// Means over seconds of rate and specific force.
struct Seconds {
  std::vector<double> rate;  ///< length, rad/s
  std::array<std::vector<double>, 3> force;
  std::vector<double> force_length;
};

Seconds seconds_of(const core::ImuData& imu, double step) {
  Seconds out;
  const size_t n = std::max<size_t>(1, static_cast<size_t>(std::lround(1.0 / step)));
  for (size_t first = 0; first < imu.size(); first += n) {
    const size_t last = std::min(imu.size(), first + n);
    if (first > 0 && last - first < (n + 1) / 2) break;
    Vector3d angle = Vector3d::Zero(), velocity = Vector3d::Zero();
    double time = 0;
    for (size_t k = first; k < last; ++k) {
      angle += imu.angle[k];
      velocity += imu.velocity[k];
      time += imu.step[k];
    }
    const Vector3d force = velocity / time;
    out.rate.push_back(angle.norm() / time);
    for (size_t c = 0; c < 3; ++c) out.force[c].push_back(force[static_cast<Eigen::Index>(c)]);
    out.force_length.push_back(force.norm());
  }
  return out;
}

/// The unit or kind by which the specific force would be gravity best; empty where none does within `sure`.
std::string unit_hint(double ratio, const ImuFile& file, double step) {
  constexpr std::array units{AccelerationUnit::mps2, AccelerationUnit::g, AccelerationUnit::mg};
  double nearest = sure;
  std::string best;
  for (const ImuKind kind : {file.kind, file.kind == ImuKind::rates ? ImuKind::increments : ImuKind::rates})
    for (const AccelerationUnit unit : units) {
      const double by_kind = kind == file.kind ? 1.0 : kind == ImuKind::increments ? 1.0 / step : step;
      const double would_be = ratio * by_kind * mps2_per(unit) / mps2_per(file.acceleration_unit);
      if (std::abs(would_be - 1) >= nearest || (kind == file.kind && unit == file.acceleration_unit)) continue;
      nearest = std::abs(would_be - 1);
      best = "with ";
      if (kind != file.kind) best += "kind = \"" + std::string(core::Choices<ImuKind>::names[static_cast<size_t>(kind)]) + "\"";
      if (kind != file.kind && unit != file.acceleration_unit) best += " and ";
      if (unit != file.acceleration_unit)
        best += "acceleration_unit = \"" + std::string(core::Choices<AccelerationUnit>::names[static_cast<size_t>(unit)]) + "\"";
      best += " it would be " + text("%.2f m/s2", would_be * gravity);
    }
  return best;
}

std::string opposite(const std::string& axis) { return axis[0] == '-' ? axis.substr(1) : "-" + axis; }

/// Axes that put gravity right, where the mounting does not turn them further. `up`: the component that carries it, `sign` its sign.
std::string axes_hint(const ImuFile& f, size_t up, bool positive) {
  if (f.roll.value != 0 || f.pitch.value != 0 || f.heading.value != 0) return "check axes, roll, pitch and heading of the mounting";
  const auto& a = f.axes;
  const auto turned = [&](const std::string& axis, bool minus) { return minus ? opposite(axis) : axis; };
  std::array<std::string, 3> to;
  if (up == 2) to = {a[0], opposite(a[1]), opposite(a[2])};
  if (up == 0) to = {a[1], turned(a[2], positive), turned(a[0], positive)};
  if (up == 1) to = {a[0], turned(a[2], !positive), turned(a[1], positive)};
  return "the axis that points down is " + to[2] + ": for example axes = [\"" + to[0] + "\", \"" + to[1] + "\", \"" + to[2] + "\"]";
}

void check_force(const Seconds& s, const ImuFile& file, double step, const std::string& name, core::Tally& tally) {
  const double length = core::median(s.force_length), ratio = length / gravity;
  const std::string found = text("median specific force %.4g m/s2, gravity is %.2f m/s2", length, gravity);
  if (std::abs(ratio - 1) > near_gravity) {
    const std::string hint = unit_hint(ratio, file, step);
    if (ratio < 0.5 || ratio > 2 || !hint.empty())
      throw core::Error(found, name, hint.empty() ? "check kind, acceleration_unit and accelerometer_factor" : hint);
    tally.count("IMU files whose specific force is not gravity in the median", name + ": " + found);
  }
  const Vector3d f(core::median(s.force[0]), core::median(s.force[1]), core::median(s.force[2]));
  const double tilt = core::to_degrees(std::acos(std::clamp(-f.z() / f.norm(), -1.0, 1.0)));
  const std::string vector = text("median specific force (%.2f, %.2f, %.2f) m/s2 forward, right, down", f.x(), f.y(), f.z());
  if (tilt > side) {
    Eigen::Index up = 0;
    f.cwiseAbs().maxCoeff(&up);
    throw core::Error("gravity is not along the axis that is stated to point down: " + vector + "; a level vehicle feels (0, 0, -9.81)",
                      name, axes_hint(file, static_cast<size_t>(up), f[up] > 0));
  }
  if (tilt > level)
    tally.count("IMU files that are not level in the median: check the mounting", name + ": " + vector + text(", %.0f deg from up", tilt));
}

void check_rate(const Seconds& s, const std::string& name, core::Tally& tally) {
  const double rate = core::median(s.rate);
  const std::string found = text("median over seconds %.3g rad/s = %.3g deg/s", rate, core::to_degrees(rate));
  if (rate > impossible)
    throw core::Error("angular rates no vehicle has: " + found, name,
                      "check angle_unit (degrees stated as radians?), kind and gyro_factor");
  if (rate > fast) tally.count("IMU files with implausibly large angular rates: degrees stated as radians?", name + ": " + found);
  std::vector<double> sorted = s.rate;
  std::sort(sorted.begin(), sorted.end());
  const double most = sorted[static_cast<size_t>(0.99 * static_cast<double>(sorted.size() - 1))];
  if (most < slow_turn)
    tally.count("IMU files that hardly turn: radians stated as degrees, or it stood still",
                name + ": " + text("99 %% of the seconds turn by less than %.2g deg/s", core::to_degrees(most)));
}

}  // namespace

void check_imu(const core::ImuData& imu, const ImuFile& file, double step, const std::string& name, core::Tally& tally) {
  if (imu.size() == 0) return;
  const Seconds s = seconds_of(imu, step);
  check_force(s, file, step, name, tally);
  check_rate(s, name, tally);
}

}  // namespace swath::io
