// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/clock/latency.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "core/config/result_visitors.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::trajectory {
namespace {

using Eigen::Vector3d;

class Noise {
 public:
  explicit Noise(unsigned seed) : bits_(seed) {}
  double operator()() {
    const double u = (static_cast<double>(bits_()) + 0.5) / 4294967296.0, v = (static_cast<double>(bits_()) + 0.5) / 4294967296.0;
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * M_PI * v);
  }

 private:
  std::mt19937 bits_;
};

/// A survey flight in closed form: lines with turns, gusts in speed. North, east, down, m.
struct Flight {
  double speed = 60, gust = 3, turns = 1;
  Vector3d place(double t) const {
    const double w = 2 * M_PI / 120;
    return {speed * t + gust * 15 / (2 * M_PI) * std::sin(2 * M_PI * t / 15), turns * 800 * std::sin(w * t),
            -1000 + turns * 5 * std::sin(2 * M_PI * t / 40)};
  }
  double heading(double t) const {
    const double w = 2 * M_PI / 120;
    return std::atan2(turns * 800 * w * std::cos(w * t), speed) + 0.02 * std::sin(2 * M_PI * t / 4) + 0.01 * std::sin(2 * M_PI * t / 1.7);
  }
};

struct Record {
  double rate = 5, seconds = 300, sigma = 0.03;
  double correlated = 0, memory = 5;  // share of the variance; its time, s
  double delay = 0;                   // of the time stamps: stamp = true time - latency
  double phase = 0;                   // of the first record
};

Motion record(const std::function<Vector3d(double)>& truth, const Record& r, Noise& noise) {
  Motion m;
  Vector3d slow = Vector3d::Zero();
  const double keep = std::exp(-1 / (r.rate * r.memory));
  for (int a = 0; a < 3; ++a) slow[a] = noise();
  for (int i = 0; i < static_cast<int>(r.seconds * r.rate); ++i) {
    const double t = r.phase + i / r.rate;
    Vector3d e;
    for (int a = 0; a < 3; ++a) {
      slow[a] = keep * slow[a] + std::sqrt(1 - keep * keep) * noise();
      e[a] = std::sqrt(r.correlated) * slow[a] + std::sqrt(1 - r.correlated) * noise();
    }
    m.time.push_back(t - r.delay);
    m.value.push_back(truth(t) + r.sigma * e);
  }
  return m;
}

std::function<Vector3d(double)> place_of(const Flight& f) {
  return [f](double t) { return f.place(t); };
}

// 150 runs tell a ratio to 6 %; what the estimated autocorrelation leaves of it is another 10 %.
constexpr int seeds = 150;
constexpr double ratio_low = 0.82, ratio_high = 1.18;

struct Score {
  double ratio = 0, rms = 0, bias = 0;
};

Score score(const std::function<LatencyResult(unsigned, double&)>& run) {
  Score s;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    double truth = 0;
    const LatencyResult r = run(seed, truth);
    EXPECT_TRUE(r.determinable) << r.reason;
    const double e = r.latency - truth;
    s.ratio += e * e / (r.sigma * r.sigma) / seeds;
    s.rms += e * e / seeds;
    s.bias += e / seeds;
  }
  s.ratio = std::sqrt(s.ratio);
  s.rms = std::sqrt(s.rms);
  return s;
}

TEST(Latency, ExactRecordsGiveTheExactLatencyWithItsSign) {
  const Flight f;
  Noise noise(1);
  for (const double latency : {-1.234, -0.01, 0.0, 0.0057, 1.5}) {
    Record device;
    device.sigma = 1e-9;
    device.delay = latency;  // stamps too early by the latency: it is added to them
    device.phase = 0.037;
    Record reference;
    reference.sigma = 1e-9;
    reference.rate = 20;
    const LatencyResult r = latency_of_places(record(place_of(f), reference, noise), record(place_of(f), device, noise));
    EXPECT_TRUE(r.determinable);
    EXPECT_NEAR(r.latency, latency, 1e-6);  // cubics through 20 Hz records
    EXPECT_GT(r.correlation, 0.9);
    EXPECT_NEAR(r.coarse, latency, 0.25);
    EXPECT_LT(r.axes_inflation, 10);
  }
}

TEST(Latency, SigmaIsTrueForWhiteAndForMildlyCorrelatedErrors) {
  const struct {
    const char* name;
    double correlated, memory;
  } cases[] = {{"white", 0, 5}, {"40 % over 5 s", 0.4, 5}, {"all over 2 s", 1, 2}};
  for (const auto& c : cases) {
    const Score s = score([&](unsigned seed, double& truth) {
      Noise noise(seed);
      truth = 0.05 + 0.001 * seed;
      Record reference, device;
      reference.sigma = 0.02;
      device.correlated = c.correlated;
      device.memory = c.memory;
      device.delay = truth;
      device.phase = 0.013;
      const Motion a = record(place_of({}), reference, noise);
      return latency_of_places(a, record(place_of({}), device, noise));
    });
    std::printf("places, %s: error/sigma %.3f, rms %.1f us\n", c.name, s.ratio, s.rms * 1e6);
    EXPECT_GT(s.ratio, ratio_low) << c.name;
    EXPECT_LT(s.ratio, ratio_high) << c.name;
  }
}

TEST(Latency, SigmaIsTrueWithAShiftBesideIt) {
  for (const LatencyShift shift : {LatencyShift::axes, LatencyShift::track}) {
    const Score s = score([&](unsigned seed, double& truth) {
      Noise noise(seed);
      truth = -0.02;
      Record reference, device;
      device.delay = truth;
      LatencyOptions o;
      o.shift = shift;
      Motion b = record(place_of({}), device, noise);
      if (shift == LatencyShift::axes)
        for (Vector3d& v : b.value) v += Vector3d(0.5, -0.3, 0.2);
      return latency_of_places(record(place_of({}), reference, noise), b, o);
    });
    std::printf("places with shift: error/sigma %.3f, rms %.1f us, mean %.1f us\n", s.ratio, s.rms * 1e6, s.bias * 1e6);
    EXPECT_GT(s.ratio, ratio_low);
    EXPECT_LT(s.ratio, ratio_high);
  }
}

TEST(Latency, TurnRatesOfGnssAgainstAnImu) {
  const Flight f;
  const auto rate = [f](double t) { return Vector3d((f.heading(t + 1e-4) - f.heading(t - 1e-4)) / 2e-4, 0, 0); };
  const Score s = score([&](unsigned seed, double& truth) {
    Noise noise(seed);
    truth = 0.012;
    Record imu, gnss;
    imu.rate = 50;
    imu.seconds = gnss.seconds = 150;
    imu.sigma = 0.002;
    gnss.rate = 10;
    gnss.sigma = 0.01;
    gnss.delay = truth;
    LatencyOptions o;
    o.shift = LatencyShift::axes;
    o.smoothing = core::Seconds(0.2);
    Motion a = record(rate, imu, noise), b = record(rate, gnss, noise);
    for (Vector3d& v : a.value) v = {v.x() + 0.003, 0, 0};  // the gyro's bias
    for (Vector3d& v : b.value) v = {v.x(), 0, 0};
    return latency_of_rates(a, b, o);
  });
  std::printf("rates: error/sigma %.3f, rms %.1f us\n", s.ratio, s.rms * 1e6);
  EXPECT_GT(s.ratio, ratio_low);
  EXPECT_LT(s.ratio, ratio_high);
}

TEST(Latency, WildRecordsAreDownWeighted) {
  Noise noise(7);
  Record reference, device;
  device.delay = 0.1;
  Motion b = record(place_of({}), device, noise);
  for (size_t i = 3; i < b.value.size(); i += 20) b.value[i] += Vector3d(40, -30, 20);
  const LatencyResult r = latency_of_places(record(place_of({}), reference, noise), b);
  EXPECT_TRUE(r.determinable);
  EXPECT_NEAR(r.latency, 0.1, 3e-4);
  EXPECT_GE(r.outliers, 70u);
}

TEST(Latency, StraightFlightRestsOnTheSamePointOfTheCarrier) {
  Flight straight;
  straight.gust = 0;
  straight.turns = 0;
  Noise noise(3);
  Record reference, device;
  device.delay = 0.3;
  const Motion a = record(place_of(straight), reference, noise), b = record(place_of(straight), device, noise);
  const LatencyResult r = latency_of_places(a, b);
  EXPECT_TRUE(r.determinable) << "along-track places do tell";
  EXPECT_NEAR(r.latency, 0.3, 5 * r.sigma);
  EXPECT_LT(r.correlation, 0.5);
  EXPECT_GT(r.axes_inflation, 1e3);
  EXPECT_NE(r.reason.find("straight"), std::string::npos);
  for (const LatencyShift shift : {LatencyShift::axes, LatencyShift::track}) {
    LatencyOptions o;
    o.shift = shift;
    const LatencyResult none = latency_of_places(a, b, o);
    EXPECT_FALSE(none.determinable);
    EXPECT_EQ(none.sigma, 0);
    EXPECT_NE(none.reason.find("constant shift"), std::string::npos) << none.reason;
  }
  // Turns at one speed: a datum shift is told apart, another point of the carrier is not.
  const auto circle = [](double t) { return Vector3d(1000 * std::sin(0.06 * t), 1000 * std::cos(0.06 * t), 0); };
  const LatencyResult turning = latency_of_places(record(circle, reference, noise), record(circle, device, noise));
  EXPECT_LT(turning.axes_inflation, 2);
  EXPECT_GT(turning.track_inflation, 1e3);
  EXPECT_NE(turning.reason.find("one speed"), std::string::npos);
}

TEST(Latency, WhatCannotBeToldIsNotTold) {
  Noise noise(5);
  Record r;
  const auto still = [](double) { return Vector3d(1, 2, 3); };
  EXPECT_FALSE(latency_of_places(record(still, r, noise), record(still, r, noise)).determinable);
  Record later = r;
  later.phase = 1000;
  const LatencyResult apart = latency_of_places(record(place_of({}), r, noise), record(place_of({}), later, noise));
  EXPECT_FALSE(apart.determinable);
  EXPECT_FALSE(apart.reason.empty());
  Record far = r;
  far.delay = 3.5;
  EXPECT_FALSE(latency_of_places(record(place_of({}), r, noise), record(place_of({}), far, noise)).determinable) << "beyond the search";
  EXPECT_FALSE(latency_of_places({}, {}).determinable);
}

TEST(Latency, OfPlacesOnEarth) {
  const Vector3d origin = core::ecef_of({0.8, 0.2, 0});
  const Eigen::Matrix3d ecef_R_ned = core::ecef_R_ned(0.8, 0.2);
  const Flight f;
  std::vector<double> times[2];
  std::vector<Vector3d> places[2];
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 2000; ++i) {
      const double t = 0.1 * i;
      times[k].push_back(1.4e9 + t - (k == 1 ? 0.25 : 0));
      places[k].push_back(origin + ecef_R_ned * f.place(t));
    }
  places[1][7].setConstant(std::nan(""));
  const Motion device = places_of(times[1], places[1], origin, 1.4e9);
  EXPECT_EQ(device.time.size(), 1999u);
  const LatencyResult r = latency_of_places(places_of(times[0], places[0], origin, 1.4e9), device);
  EXPECT_NEAR(r.latency, 0.25, 1e-5);
  const core::Value report = core::reported(r);
  EXPECT_TRUE(report.find("determinable")->as_bool());
  EXPECT_NEAR(report.find("latency_s")->as_number(), 0.25, 1e-5);
  const core::Value none = core::reported(latency_of_places({}, {}));
  EXPECT_EQ(none.find("latency_s"), nullptr);
  EXPECT_EQ(none.find("reason")->as_text(), "too few records");
}

}  // namespace
}  // namespace swath::trajectory
