// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/preset.h"

#include "core/option_visitors.h"

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

Options read_options(const core::Value& given) {
  const core::Value* flight = given.is_object() ? given.find("flight") : nullptr;
  const core::Value* pattern = flight && flight->is_object() ? flight->find("pattern") : nullptr;
  Options options = pattern && pattern->is_text() && pattern->as_text() == "calibration" ? calibration_flight() : Options{};
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
