// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/options.h"

#include <algorithm>
#include <cmath>

namespace swath::simulate {

using core::degrees;
using core::Metres;

core::Calibration default_calibration() {
  core::Calibration c;
  c.roll = degrees(0.05);
  c.pitch = degrees(0.12);
  c.heading = degrees(-0.15);
  c.lever_arm_scanner = {Metres(0.185), Metres(-0.072), Metres(0.324)};
  c.range_offset = Metres(0.04);
  c.scan_scale = 1.0003;
  return c;
}

CalibrationSigma default_drawn_sigma() {
  CalibrationSigma s;
  s.roll = s.pitch = degrees(0.002);
  s.heading = degrees(0.004);
  s.lever_arm = Metres(0.005);
  s.range_offset = Metres(0.005);
  s.scan_scale = 2e-5;
  return s;
}

CalibrationSigma default_nominal_sigma() {
  CalibrationSigma s;
  s.roll = s.pitch = s.heading = degrees(0.2);
  s.lever_arm = Metres(0.005);
  s.range_offset = Metres(0.05);
  s.scan_scale = 5e-4;
  return s;
}

bool is_axes_rotation(const std::array<std::string, 3>& axes) {
  std::array<int, 3> place{};
  int sign = 1;
  for (size_t i = 0; i < 3; ++i) {
    const std::string& a = axes[i];
    const bool minus = a.size() == 2 && a[0] == '-';
    if (!(minus || a.size() == 1) || a.back() < 'x' || a.back() > 'z') return false;
    place[i] = a.back() - 'x';
    if (minus) sign = -sign;
  }
  // The sign of a permutation of 0, 1, 2; 0 where one comes twice.
  return sign * (place[1] - place[0]) * (place[2] - place[0]) * (place[2] - place[1]) == 2;
}

double FlightOptions::upper_height() const {
  if (pattern != FlightPattern::calibration) return 0.0;
  return second_height ? second_height->value : 11.0 / 7.0 * height.value;
}

double FlightOptions::highest(double ground) const {
  double out = line.empty() ? std::max(height.value, upper_height()) : line[0].height.value - ground;
  for (const LineOptions& l : line) out = std::max(out, l.height.value - ground);
  return out;
}

double FlightOptions::lowest(double ground) const {
  double out = line.empty() ? height.value : line[0].height.value - ground;
  for (const LineOptions& l : line) out = std::min(out, l.height.value - ground);
  return line.empty() && upper_height() > 0.0 ? std::min(out, upper_height()) : out;
}

BuildingSize airfield_building(const WorldOptions& w) {
  const double length = std::clamp(std::min(w.length.value, w.width.value) / 9.0, 12.0, 80.0);
  return {0.5 * length, 0.25 * length, 12.0};
}

core::ScannerModel model_of(Pattern p) {
  switch (p) {
    case Pattern::triangle:
    case Pattern::sine:
      return core::ScannerModel::mirror;
    case Pattern::polygon:
      return core::ScannerModel::polygon;
    case Pattern::profile:
      return core::ScannerModel::profile;
    case Pattern::beam:
    case Pattern::multibeam:
      return core::ScannerModel::beam;
    case Pattern::conical:
      return core::ScannerModel::conical;
    case Pattern::palmer:
      return core::ScannerModel::palmer;
  }
  return core::ScannerModel::mirror;
}

double least_side_with_hall(const WorldOptions& w) { return std::hypot(w.hall_length.value, w.hall_width.value) + 10.0; }

namespace {

/// A scene as its name has it.
Features usual_features(Scene scene) {
  switch (scene) {
    case Scene::flat:
      return {.slope = 0.01};
    case Scene::hills:
      return {.slope = 0.02, .relief = 20, .trees = 40, .low_vegetation = 0.1, .woodland = 0.1};
    case Scene::steep:
      return {.slope = 0.25, .relief = 30, .scarp = 12, .trees = 60, .low_vegetation = 0.2, .woodland = 0.25};
    case Scene::forest:
      return {.slope = 0.08, .relief = 12, .trees = 250, .low_vegetation = 0.3, .woodland = 0.75};
    case Scene::town:
      return {.slope = 0.01,
              .relief = 2,
              .buildings = 9,
              .trees = 30,
              .low_vegetation = 0.05,
              .power_line = true,
              .woodland = 0.2,
              .built_up = 0.7};
    case Scene::mixed:
      return {.slope = 0.03,
              .relief = 8,
              .scarp = 5,
              .embankment = 3,
              .buildings = 6,
              .trees = 150,
              .low_vegetation = 0.15,
              .water = true,
              .power_line = true,
              .woodland = 0.25,
              .built_up = 0.35};
    case Scene::zoo:
      return {.slope = 0.03,
              .relief = 8,
              .scarp = 9,
              .embankment = 4,
              .ditch = 5,
              .buildings = 7,
              .trees = 600,
              .low_vegetation = 0.1,
              .crops = 0.8,
              .water = true,
              .power_line = true,
              .hall = true,
              .bridge = true,
              .woodland = 0.3,
              .built_up = 0.3,
              .foliage = 0.4,
              .scarp_slope = 1.43,
              .embankment_at = -0.05};
    case Scene::airfield:
      return {.slope = 0.002, .relief = 0.4, .buildings = 0.3, .trees = 0.4};
  }
  return {};
}

}  // namespace

Features features_of(const WorldOptions& w) {
  Features f = usual_features(w.scene);
  if (w.slope) f.slope = *w.slope;
  if (w.relief) f.relief = w.relief->value;
  if (w.scarp) f.scarp = w.scarp->value;
  if (w.scarp_slope) f.scarp_slope = *w.scarp_slope;
  if (w.embankment) f.embankment = w.embankment->value;
  if (w.ditch) f.ditch = w.ditch->value;
  if (w.buildings) f.buildings = *w.buildings;
  if (w.trees) f.trees = *w.trees;
  if (w.woodland) f.woodland = *w.woodland;
  if (w.foliage) f.foliage = *w.foliage;
  if (w.low_vegetation) f.low_vegetation = *w.low_vegetation;
  if (w.crops) f.crops = *w.crops;
  if (w.water) f.water = *w.water;
  if (w.power_line) f.power_line = *w.power_line;
  if (w.dem) {
    f.slope = f.relief = f.scarp = f.embankment = f.ditch = 0.0;
    f.water = false;
  }
  // Without room for it, or a ditch to cross, the scene goes without.
  f.hall = w.hall.value_or(f.hall) && std::min(w.length.value, w.width.value) >= least_side_with_hall(w);
  f.bridge = w.bridge.value_or(f.bridge) && f.ditch > 0.0;
  return f;
}

}  // namespace swath::simulate
