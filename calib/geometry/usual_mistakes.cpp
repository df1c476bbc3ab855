// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/usual_mistakes.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "calib/words.h"
#include "core/config/units.h"

namespace swath::calib {
namespace {

using core::TrajectoryData;
using Column = std::vector<double> TrajectoryData::*;
using Kind = UsualMistake::Kind;

constexpr double foot = 0.3048, right_angle = 0.5 * core::pi;

std::function<void(TrajectoryData&)> scaled(Column column, double by) {
  return [=](TrajectoryData& d) {
    for (double& v : d.*column) v *= by;
  };
}

std::function<void(TrajectoryData&)> added(Column column, double by) {
  return [=](TrajectoryData& d) {
    for (double& v : d.*column) v += by;
  };
}

/// Roll and pitch exchanged, each with a sign.
std::function<void(TrajectoryData&)> exchanged(double roll, double pitch) {
  return [=](TrajectoryData& d) {
    for (size_t i = 0; i < d.size(); ++i) {
      const double r = d.roll[i], p = d.pitch[i];
      d.roll[i] = roll * p;
      d.pitch[i] = pitch * r;
    }
  };
}

std::string degrees_text(double angle) { return words("%.4g deg", core::to_degrees(angle)); }

void add_angles(std::vector<UsualMistake>& out) {
  const auto scan = [](double by) { return [by](Chain& c) { c.calibration.scan_scale *= by; }; };
  out.push_back({"scan_angle_sign",
                 "with the sign of the scan angle reversed",
                 "state angle_to_port in [[laser]] the other way round",
                 scan(-1.0),
                 {},
                 Kind::gross});
  out.push_back({"scan_angle_degrees_as_radians",
                 "with scan angles 57.3 times larger (radians were read as degrees)",
                 "state angle_unit = \"rad\" in [[laser]]",
                 scan(180 / core::pi),
                 {},
                 Kind::gross});
  out.push_back({"scan_angle_degrees_as_radians",
                 "with scan angles 57.3 times smaller (degrees were read as radians)",
                 "state angle_unit = \"deg\" in [[laser]]",
                 scan(core::pi / 180),
                 {},
                 Kind::gross});
  out.push_back({"scan_angle_gon",
                 "with scan angles as gon in place of degrees",
                 "state angle_unit = \"gon\" in [[laser]]",
                 scan(0.9),
                 {},
                 Kind::gross});
  out.push_back({"scan_angle_gon",
                 "with scan angles as degrees in place of gon",
                 "state angle_unit = \"deg\" in [[laser]]",
                 scan(1 / 0.9),
                 {},
                 Kind::gross});
  out.push_back({"scan_scale",
                 "with scan angles twice as large (optical angles are twice the mirror's)",
                 "state twice the scan_scale in [calibration]",
                 scan(2.0),
                 {},
                 Kind::gross});
  out.push_back({"scan_scale",
                 "with scan angles half as large (mirror angles are half the optical ones)",
                 "state half the scan_scale in [calibration]",
                 scan(0.5),
                 {},
                 Kind::gross});
}

void add_ranges(double offset, std::vector<UsualMistake>& out) {
  const auto range = [](double by) { return [by](Chain& c) { c.calibration.range_scale *= by; }; };
  out.push_back({"range_feet", "with ranges in feet", "state range_unit = \"1 ft\" in [[laser]]", range(foot), {}, Kind::ranges});
  out.push_back({"range_feet",
                 "with ranges in metres in place of feet",
                 "state range_unit = \"1 m\" in [[laser]]",
                 range(1 / foot),
                 {},
                 Kind::ranges});
  out.push_back({"range_two_way",
                 "with ranges half as long (two-way ranges)",
                 "state range_unit = \"0.5 m\" in [[laser]]",
                 range(0.5),
                 {},
                 Kind::ranges});
  out.push_back({"range_two_way",
                 "with ranges twice as long (halved ranges)",
                 "state range_unit = \"2 m\" in [[laser]]",
                 range(2.0),
                 {},
                 Kind::ranges});
  for (const auto& [by, name, unit] : {std::tuple(0.01, "centimetres", "1 cm"), std::tuple(1e-3, "millimetres", "1 mm")})
    out.push_back({"range_centimetres",
                   std::string("with ranges in ") + name,
                   std::string("state range_unit = \"") + unit + "\" in [[laser]]",
                   range(by),
                   {},
                   Kind::ranges});
  if (std::abs(offset) > 3.0)
    out.push_back({"range_offset",
                   "with the range offset in millimetres",
                   "state range_offset of [calibration] in mm",
                   [](Chain& c) { c.calibration.range_offset.value *= 1e-3; },
                   {},
                   Kind::gross});
}

void add_model(const Chain& stated, std::vector<UsualMistake>& out) {
  using core::ScannerModel;
  const auto across = [](ScannerModel m) { return m == ScannerModel::mirror || m == ScannerModel::polygon || m == ScannerModel::beam; };
  constexpr std::pair<ScannerModel, const char*> models[] = {{ScannerModel::mirror, "mirror"},
                                                             {ScannerModel::profile, "profile"},
                                                             {ScannerModel::conical, "conical"},
                                                             {ScannerModel::palmer, "palmer"}};
  for (const auto& [model, name] : models) {
    if (model == stated.scanner.model || (across(model) && across(stated.scanner.model))) continue;
    out.push_back({"scanner_model",
                   std::string("with the scanner model ") + name,
                   std::string("state model = \"") + name + "\" in [scanner]",
                   [model = model](Chain& c) { c.scanner.model = model; },
                   {},
                   Kind::gross});
  }
}

void add_trajectory(double convergence, std::vector<UsualMistake>& out) {
  using D = TrajectoryData;
  out.push_back({"trajectory_height_feet",
                 "with the trajectory's heights in feet",
                 "export the trajectory with heights in metres",
                 {},
                 scaled(&D::height, foot),
                 Kind::gross});
  out.push_back({"roll_sign",
                 "with the sign of roll reversed",
                 "export the trajectory with roll positive right wing down",
                 {},
                 scaled(&D::roll, -1.0),
                 Kind::gross});
  out.push_back({"pitch_sign",
                 "with the sign of pitch reversed",
                 "export the trajectory with pitch positive nose up",
                 {},
                 scaled(&D::pitch, -1.0),
                 Kind::gross});
  out.push_back({"heading_sign",
                 "with the sign of heading reversed",
                 "export the trajectory with heading clockwise from north",
                 {},
                 scaled(&D::heading, -1.0),
                 Kind::gross});
  if (std::abs(convergence) > 1e-5)
    out.push_back({"heading_grid_north",
                   "with headings from grid north (" + degrees_text(convergence) + " from true north)",
                   "export the trajectory with headings from true north",
                   {},
                   added(&D::heading, convergence),
                   Kind::small,
                   convergence});
  const std::string axes = "export the trajectory with roll, pitch and heading of forward, right, down axes";
  const auto swapped = [&](std::string what, std::function<void(D&)> how) {
    out.push_back({"axes_swapped", std::move(what), axes, {}, std::move(how), Kind::gross});
  };
  for (const double r : {1.0, -1.0})
    for (const double p : {1.0, -1.0})
      swapped(std::string("with roll and pitch exchanged") + (r < 0 ? ", the new roll reversed" : "") +
                  (p < 0 ? ", the new pitch reversed" : ""),
              exchanged(r, p));
  swapped("with the heading 90 deg larger", added(&D::heading, right_angle));
  swapped("with the heading 90 deg smaller", added(&D::heading, -right_angle));
  swapped("with the heading turned by 180 deg", added(&D::heading, core::pi));
  swapped("with the heading as an angle counter-clockwise from east", [](D& d) {
    for (double& h : d.heading) h = right_angle - h;
  });
  swapped("with roll and pitch reversed", [](D& d) {
    for (double& v : d.roll) v = -v;
    for (double& v : d.pitch) v = -v;
  });
  swapped("with pitch and heading reversed", [](D& d) {
    for (double& v : d.pitch) v = -v;
    for (double& v : d.heading) v = -v;
  });
}

void add_lever_arm(const core::Calibration& c, const Eigen::Vector3d& antenna, std::vector<UsualMistake>& out) {
  using Eigen::Vector3d;
  const Vector3d stated(c.lever_arm_scanner[0].value, c.lever_arm_scanner[1].value, c.lever_arm_scanner[2].value);
  const auto lever = [&](const char* name, std::string what, std::string cure, const Vector3d& right, Kind kind) {
    if ((right - stated).norm() < 0.02) return;
    out.push_back({name,
                   std::move(what),
                   std::move(cure),
                   [right](Chain& k) {
                     for (size_t i = 0; i < 3; ++i) k.calibration.lever_arm_scanner[i].value = right[static_cast<Eigen::Index>(i)];
                   },
                   {},
                   kind});
  };
  const auto times = [&](double x, double y, double z) { return Vector3d(stated.cwiseProduct(Vector3d(x, y, z))); };
  const std::string sign = "reverse it in lever_arm_scanner of [calibration]";
  lever("lever_arm_sign", "with the lever arm's forward part reversed", sign, times(-1, 1, 1), Kind::small);
  lever("lever_arm_sign", "with the lever arm's right part reversed", sign, times(1, -1, 1), Kind::small);
  lever("lever_arm_sign", "with the lever arm's down part reversed", sign, times(1, 1, -1), Kind::small);
  lever("lever_arm_sign", "with the whole lever arm reversed", sign, times(-1, -1, -1), Kind::small);
  const std::string axes = "state lever_arm_scanner of [calibration] as forward, right, down";
  lever("lever_arm_axes", "with the lever arm taken as forward, left, up", axes, times(1, -1, -1), Kind::small);
  lever("lever_arm_axes", "with the lever arm taken as right, forward, down", axes, {stated.y(), stated.x(), stated.z()}, Kind::small);
  lever("lever_arm_axes", "with the lever arm taken as forward, down, right", axes, {stated.x(), stated.z(), stated.y()}, Kind::small);
  lever("lever_arm_axes", "with the lever arm taken as right, forward, up", axes, {stated.y(), stated.x(), -stated.z()}, Kind::small);
  lever("lever_arm_feet", "with the lever arm in feet", "state lever_arm_scanner of [calibration] in ft", times(foot, foot, foot),
        Kind::small);
  if (!antenna.isZero())
    lever("trajectory_antenna", "with the trajectory taken as the antenna's, not the IMU's",
          "export the trajectory for the IMU's centre, or state the lever arm from the antenna to the scanner", stated - antenna,
          Kind::small);
  if (stated.lpNorm<Eigen::Infinity>() > 3.0) {
    lever("lever_arm_millimetres", "with the lever arm in millimetres", "state lever_arm_scanner of [calibration] in mm",
          times(1e-3, 1e-3, 1e-3), Kind::gross);
    lever("lever_arm_millimetres", "with the lever arm in centimetres", "state lever_arm_scanner of [calibration] in cm",
          times(1e-2, 1e-2, 1e-2), Kind::gross);
  }
}

/// Units and axes of the boresight.
void add_boresight(const core::Calibration& c, std::vector<UsualMistake>& out) {
  using Angle = core::Radians core::Calibration::*;
  constexpr double least = 1e-6;
  const double largest = std::max({std::abs(c.roll.value), std::abs(c.pitch.value), std::abs(c.heading.value)});
  const auto all_times = [&](const char* name, const char* what, const char* cure, double by) {
    out.push_back({name,
                   what,
                   cure,
                   [by](Chain& k) {
                     for (const Angle a : {&core::Calibration::roll, &core::Calibration::pitch, &core::Calibration::heading})
                       (k.calibration.*a).value *= by;
                   },
                   {},
                   Kind::gross});
  };
  if (largest > 0.02)
    all_times("boresight_degrees_as_radians", "with boresight angles 57.3 times smaller (degrees were read as radians)",
              "state roll, pitch and heading of [calibration] in deg", core::degree);
  else if (largest > least)
    all_times("boresight_degrees_as_radians", "with boresight angles 57.3 times larger (radians were read as degrees)",
              "state roll, pitch and heading of [calibration] in rad", 1 / core::degree);
  if (std::abs(c.roll.value - c.pitch.value) > least)
    out.push_back({"boresight_axes_swapped",
                   "with boresight roll and pitch exchanged",
                   "exchange roll and pitch in [calibration]",
                   [](Chain& k) { std::swap(k.calibration.roll.value, k.calibration.pitch.value); },
                   {},
                   Kind::small});
}

void add_mounting(const Chain& stated, std::vector<UsualMistake>& out) {
  const core::Calibration& c = stated.calibration;
  using Angle = core::Radians core::Calibration::*;
  const auto turn = [&](const char* name, std::string what, std::string cure, Angle angle, double factor, double plus, Kind kind) {
    out.push_back({name,
                   std::move(what),
                   std::move(cure),
                   [=](Chain& k) { (k.calibration.*angle).value = factor * (k.calibration.*angle).value + plus; },
                   {},
                   kind});
  };
  const std::string sign = "reverse it in [calibration]";
  constexpr double least = 1e-6;
  if (std::abs(c.roll.value) > least)
    turn("boresight_roll_sign", "with the sign of the boresight roll reversed", sign, &core::Calibration::roll, -1, 0, Kind::small);
  if (std::abs(c.pitch.value) > least)
    turn("boresight_pitch_sign", "with the sign of the boresight pitch reversed", sign, &core::Calibration::pitch, -1, 0, Kind::small);
  if (std::abs(c.heading.value) > least)
    turn("boresight_heading_sign", "with the sign of the boresight heading reversed", sign, &core::Calibration::heading, -1, 0,
         Kind::small);
  if (std::abs(c.roll.value) + std::abs(c.pitch.value) + std::abs(c.heading.value) > least)
    out.push_back({"boresight_sign",
                   "with all boresight angles reversed",
                   "reverse roll, pitch and heading in [calibration]",
                   [](Chain& k) {
                     for (const Angle a : {&core::Calibration::roll, &core::Calibration::pitch, &core::Calibration::heading})
                       (k.calibration.*a).value *= -1;
                   },
                   {},
                   Kind::small});
  const std::string mount = "state how the scanner is mounted by the angles of [calibration]";
  for (const double a : {right_angle, -right_angle, core::pi}) {
    turn("mount_rolled", "with the scanner rolled by " + degrees_text(a), mount, &core::Calibration::roll, 1, a, Kind::gross);
    if (a != core::pi)
      turn("mount_pitched", "with the scanner pitched by " + degrees_text(a), mount, &core::Calibration::pitch, 1, a, Kind::gross);
    turn("mount_rolled", "with the scanner turned by " + degrees_text(a) + " in heading", mount, &core::Calibration::heading, 1, a,
         Kind::gross);
  }
}

}  // namespace

std::vector<UsualMistake> usual_mistakes(const Chain& stated, double convergence, const Eigen::Vector3d& antenna) {
  std::vector<UsualMistake> out;
  add_angles(out);
  add_ranges(stated.calibration.range_offset.value, out);
  add_model(stated, out);
  add_trajectory(convergence, out);
  add_lever_arm(stated.calibration, antenna, out);
  add_boresight(stated.calibration, out);
  add_mounting(stated, out);
  return out;
}

}  // namespace swath::calib
