// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/preset.h"

#include "core/config/option_visitors.h"

namespace swath::simulate {

Options calibration_flight() {
  Options o;
  o.world.scene = Scene::airfield;
  o.world.length = o.world.width = core::Metres(720);
  o.flight.pattern = FlightPattern::calibration;
  o.flight.height = core::Metres(700);
  o.flight.speed = core::MetresPerSecond(60);
  o.flight.cross_lines = 2;
  o.flight.lead = core::Seconds(10);
  o.scanner.prf = core::Hertz(30000);
  o.scanner.frequency = core::Hertz(30);
  o.scanner.half_angle = core::degrees(27);
  o.noise.range = core::Metres(0.02);
  core::Calibration& c = o.mounting.truth;
  c.roll = c.pitch = c.heading = core::Radians(0);
  c.range_offset = core::Metres(0);
  c.scan_scale = 1.0;
  o.mounting.deliver = Deliver::nominal;
  o.mounting.random_boresight = core::degrees(0.5);
  o.mounting.random_range_offset = core::Metres(0.1);
  o.mounting.random_scan_scale = 1e-4;
  o.control.roof = true;
  o.control.points = 20;
  o.output.truth_returns = false;
  o.output.dtm_cell = core::Metres(2);
  return o;
}

Options zoo_survey() {
  Options o;
  o.world.scene = Scene::zoo;
  o.world.length = core::Metres(600);
  o.world.width = core::Metres(400);
  o.flight.lines = 2;
  o.flight.overlap = 0.4;
  o.flight.cross_lines = 0;
  o.flight.height = core::Metres(500);
  o.flight.speed = core::MetresPerSecond(50);
  o.scanner.prf = core::Hertz(60000);
  o.scanner.frequency = core::Hertz(50);
  o.scanner.half_angle = core::degrees(22);
  o.noise.high_points = 1e-4;
  o.noise.low_points = 1e-4;
  o.noise.multipath = 3e-4;
  o.noise.low_groups = 1.0;
  o.imu.file = o.gnss.file = false;
  return o;
}

Options read_options(const core::Value& given) {
  const auto says = [&](const char* table, const char* key, std::string_view text) {
    const core::Value* t = given.is_object() ? given.find(table) : nullptr;
    const core::Value* v = t && t->is_object() ? t->find(key) : nullptr;
    return v && v->is_text() && v->as_text() == text;
  };
  Options options = says("flight", "pattern", "calibration") ? calibration_flight()
                    : says("world", "scene", "zoo")          ? zoo_survey()
                                                             : Options{};
  std::vector<core::Fault> faults;
  core::read_options(core::described(options), given, "", faults);
  core::throw_if_any(faults);
  return options;
}

Options preset(Scene scene) {
  if (scene == Scene::airfield) {
    Options o = calibration_flight();
    o.world.length = o.world.width = core::Metres(300);
    o.world.buildings = 0.9;
    o.flight.height = core::Metres(300);
    o.flight.speed = core::MetresPerSecond(40);
    o.flight.bank = core::degrees(30);
    o.scanner.prf = core::Hertz(4500);
    o.scanner.frequency = core::Hertz(12);
    o.output.truth_returns = true;
    return o;
  }
  if (scene == Scene::zoo) {
    Options o = zoo_survey();
    o.scanner.prf = core::Hertz(6000);
    o.scanner.frequency = core::Hertz(16);
    return o;
  }
  Options o;
  o.world.scene = scene;
  if (scene == Scene::mixed) return o;
  o.world.length = core::Metres(160);
  o.world.width = core::Metres(120);
  o.flight.lines = 2;
  o.flight.cross_lines = 0;
  o.flight.height = core::Metres(250);
  o.scanner.prf = core::Hertz(3000);
  o.scanner.frequency = core::Hertz(20);
  return o;
}

}  // namespace swath::simulate
