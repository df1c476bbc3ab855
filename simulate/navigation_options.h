// SPDX-License-Identifier: GPL-3.0-or-later
// Options of IMU, GNSS receiver, computer clock and events.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/records/imu_spec.h"
#include "io/survey/navigation.h"

namespace swath::simulate {

/// A grade without anything known better.
inline core::ImuSpec spec_of(core::ImuGrade grade) {
  core::ImuSpec s;
  s.grade = grade;
  return s;
}

struct ImuOptions {
  bool file = true;
  core::ImuSpec spec = spec_of(core::ImuGrade::tactical);
  core::Hertz rate{200.0};
  io::ImuKind kind = io::ImuKind::increments;
  std::array<std::string, 3> axes{"x", "y", "z"};
  core::Radians roll, pitch, heading;
};

/// The signed permutation of `axes` is a rotation: x, y, z once each, right-handed.
bool is_axes_rotation(const std::array<std::string, 3>& axes);

template <class V>
void describe(ImuOptions& o, V& v) {
  v.option("file", o.file, "Writes imu.csv.");
  describe(o.spec, v);
  v.option("rate", o.rate, core::within(50, 1000), "Records per second.");
  v.option("kind", o.kind, "Increments over the interval that ends at the time stamp, or rates: their mean over it.");
  v.option("axes", o.axes, "Axes of the record that point forward, right and down, as in survey.toml.");
  v.option("roll", o.roll, core::one_turn(), "Mounting: the rotation sensor to body after `axes`, as in survey.toml.");
  v.option("pitch", o.pitch, core::within(-1.5, 1.5), "Pitch of the mounting.");
  v.option("heading", o.heading, core::one_turn(), "Heading of the mounting.");
  v.check(o.spec.grade != core::ImuGrade::unstated, "the grade of the IMU must be stated (`perfect` has no errors)");
  v.check(o.kind != io::ImuKind::unstated, "the kind must be increments or rates");
  v.check(is_axes_rotation(o.axes), "axes name each of x, y and z once, each with its sign, and are right-handed");
}

/// A stretch of the flight.
struct Stretch {
  core::Seconds start, length;
  bool holds(double t) const { return t >= start.value && t < start.value + length.value; }
};

template <class V>
void describe(Stretch& s, V& v) {
  v.option("start", s.start, core::at_least(0), "From the start of the flight.");
  v.option("length", s.length, core::at_least(0), "How long.");
}

struct GnssOptions {
  bool file = true;
  core::Hertz rate{5.0};
  core::Metres sigma_horizontal{0.02}, sigma_vertical{0.04};
  double correlated_share = 0.4;
  core::Seconds correlation_time{120.0};
  std::vector<Stretch> outages, floats;
  double float_factor = 10.0;
  double outlier_share = 0.0;
  core::Metres outlier_size{1.0};
  bool velocity = false;
  core::MetresPerSecond sigma_velocity{0.03};
  core::Seconds latency, latency_error;
  std::array<core::Metres, 3> lever_arm_error{};
  core::Metres lever_arm_sigma{0.02};
};

template <class V>
void describe(GnssOptions& o, V& v) {
  v.option("file", o.file, "Writes gnss.csv, positions of the antenna.");
  v.option("rate", o.rate, core::within(0.1, 100), "Fixes per second.");
  v.option("sigma_horizontal", o.sigma_horizontal, core::within(1e-4, 100),
           "Sigma of a fix, north and east each, white and correlated part together (root mean square).");
  v.option("sigma_vertical", o.sigma_vertical, core::within(1e-4, 100), "Sigma of a fix's height.");
  v.option("correlated_share", o.correlated_share, core::within(0, 1),
           "Share of the variance that is a first-order Gauss-Markov process, independent north, east and down.");
  v.option("correlation_time", o.correlation_time, core::within(0.1, 1e5), "Its correlation time.");
  v.tables("outage", o.outages, "Stretches without fixes.");
  v.tables("float", o.floats, "Stretches of float solutions.");
  v.option("float_factor", o.float_factor, core::within(1, 1000), "Factor on the sigmas of float solutions, stated and true.");
  v.option("outlier_share", o.outlier_share, core::within(0, 0.5), "Share of fixes that are wrong by more than they state.");
  v.option("outlier_size", o.outlier_size, core::within(0, 1e4), "Their error: half to one and a half of this, in any direction.");
  v.option("velocity", o.velocity, "Writes velocities of the antenna too.");
  v.option("sigma_velocity", o.sigma_velocity, core::within(1e-5, 10), "Sigma of each component of them.");
  v.option("latency", o.latency, core::within(-1, 1), "True latency: a fix belongs to the instant of its time stamp plus this.");
  v.option("latency_error", o.latency_error, core::within(-1, 1), "survey.toml states the true latency plus this.");
  v.option("lever_arm_error", o.lever_arm_error, core::within(-10, 10),
           "survey.toml states the true lever arm (mounting.lever_arm_antenna) plus this.");
  v.option("lever_arm_sigma", o.lever_arm_sigma, core::within(0, 10), "Sigma of the lever arm that survey.toml states.");
}

struct ClockOptions {
  core::Seconds offset{-0.9e-3};
  core::Ratio frequency{15e-6}, wander{0.5e-6};
  core::Seconds jitter{20e-6};
  int poll = 4;
  core::Seconds settling{1000.0}, before{900.0};

  double poll_seconds() const { return static_cast<double>(1 << poll); }
};

template <class V>
void describe(ClockOptions& o, V& v) {
  v.option("offset", o.offset, core::within(-0.1, 0.1), "Computer clock minus UTC when its log begins.");
  v.option("frequency", o.frequency, core::within(-5e-4, 5e-4), "By what share the undisciplined clock runs fast when its log begins.");
  v.option("wander", o.wander, core::within(0, 1e-4), "Random walk of that frequency: sigma of its change over an hour.");
  v.option("jitter", o.jitter, core::within(0, 0.1), "Sigma of one measurement of the offset (NTP).");
  v.option("poll", o.poll, core::within(1, 10), "Seconds between two measurements, as power of 2.");
  v.option("settling", o.settling, core::within(30, 1e5), "Time in which NTP pulls the clock to UTC.", "Reis2011");
  v.option("before", o.before, core::within(0, 1e5), "The log begins this long before the flight.");
  v.check(o.poll_seconds() <= o.settling.value / 16, "NTP cannot settle within 16 measurements: a shorter poll or a longer settling");
}

struct EventOptions {
  bool file = false;
  core::Seconds interval{4.0};
  core::Seconds tag_noise{5e-6}, mark_noise{50e-9};
  ClockOptions clock;
};

template <class V>
void describe(EventOptions& o, V& v) {
  v.option("file", o.file, "Writes events by the computer's clock and by the receiver, and the clock's logs.");
  v.option("interval", o.interval, core::within(0.01, 1e4), "Time between two exposures along a line.");
  v.option("tag_noise", o.tag_noise, core::within(0, 0.1), "Noise of one time tag of the computer, events and pulses per second.");
  v.option("mark_noise", o.mark_noise, core::within(0, 0.1), "Noise of one event mark of the receiver.");
  v.table("clock", o.clock, "The computer's clock.");
}

}  // namespace swath::simulate
