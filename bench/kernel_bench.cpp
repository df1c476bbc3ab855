// SPDX-License-Identifier: GPL-3.0-or-later
// Returns per second of the georeferencing kernel on one core, beside a memcpy of the columns that it reads and writes, in turn in one
// process. Prints the median of the rounds' ratios, which holds where the machine's speed drifts.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "core/geo/frames.h"
#include "georef/georeference.h"

namespace {

using namespace swath;
using Clock = std::chrono::steady_clock;

constexpr double flight_start = 1.4e9;     // GPS time, s
constexpr double pulse_rate = 500e3;       // Hz
constexpr size_t batch = 1 << 17;          // as the engine's
constexpr size_t batches_of_a_round = 16;  // 4.2 s of flight

/// A flight of 6 s at 200 Hz, 60 m/s, 1000 m above ground, with turbulence and sigmas.
core::TrajectoryData flight() {
  core::TrajectoryData d;
  for (int i = 0; i <= 1200; ++i) {
    const double s = i * 0.005;
    d.time.push_back(flight_start + s);
    d.latitude.push_back((47.9 + s * 60.0 / 111200.0) * core::degree);
    d.longitude.push_back(10.5 * core::degree);
    d.height.push_back(1600.0 + 0.5 * std::sin(0.8 * s));
    d.roll.push_back(1.0 * core::degree * std::sin(1.7 * s));
    d.pitch.push_back(2.0 * core::degree + 0.5 * core::degree * std::cos(2.3 * s));
    d.heading.push_back(core::wrap_two_pi(0.5 * core::degree * std::sin(0.9 * s)));
    d.sigma_north.push_back(0.03f), d.sigma_east.push_back(0.02f), d.sigma_down.push_back(0.05f);
    d.sigma_roll.push_back(5e-5f), d.sigma_pitch.push_back(5e-5f), d.sigma_heading.push_back(1e-4f);
  }
  return d;
}

core::Shots shots_from(size_t first) {
  core::Shots s;
  for (size_t i = first; i < first + batch; ++i) {
    const double t = static_cast<double>(i) / pulse_rate;
    s.time.push_back(flight_start + 0.5 + t);
    s.angle.push_back(20.0 * core::degree * std::sin(2.0 * core::pi * 50.0 * t));
    s.range.push_back(1000.0 / std::cos(s.angle.back()) + 10.0 * std::sin(500.0 * t));
    s.intensity.push_back(static_cast<std::uint16_t>(i % 1000));
    s.return_number.push_back(1);
    s.return_count.push_back(1);
    s.flags.push_back(0);
    s.record.push_back(static_cast<std::uint32_t>(i));
  }
  return s;
}

/// The columns that the kernel reads and writes, copied once each; returns the bytes copied.
struct Copies {
  std::vector<std::vector<char>> columns;
  size_t bytes = 0;

  void fit(const core::Shots& in, const core::Block& out) {
    columns.clear();
    bytes = 0;
    each(in, out, [&](const void*, size_t n) {
      columns.emplace_back(n);
      bytes += n;
    });
  }
  void copy(const core::Shots& in, const core::Block& out) {
    size_t k = 0;
    each(in, out, [&](const void* from, size_t n) { std::memcpy(columns[k++].data(), from, n); });
  }

 private:
  template <class F>
  static void each(const core::Shots& in, const core::Block& out, F&& f) {
    core::for_each_column(in, in, [&](const auto& c, const auto&) {
      if (!c.empty()) f(c.data(), c.size() * sizeof(c[0]));
    });
    core::for_each_column([&](core::Column, std::string_view, auto member) {
      const auto& c = out.*member;
      if (!c.empty()) f(c.data(), c.size() * sizeof(c[0]));
    });
  }
};

double seconds(Clock::time_point a, Clock::time_point b) { return std::chrono::duration<double>(b - a).count(); }

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

core::SensorSigma sigmas() {
  core::SensorSigma s;
  s.range_offset = core::Metres(0.01);
  s.scan_offset = core::degrees(0.002);
  s.latency = core::Seconds(1e-4);
  s.beam_divergence = core::Radians(3e-4);
  return s;
}

void measure(const char* name, const trajectory::Trajectory& t, const core::Scanner& scanner, bool with_sigma, int rounds) {
  const core::Crs utm("EPSG:32632");
  const georef::Georeferencer g(scanner, {}, sigmas(), t, utm, {612000.0, 5300000.0, 0.0}, with_sigma);
  std::vector<core::Shots> shots;
  for (size_t b = 0; b < batches_of_a_round; ++b) shots.push_back(shots_from(b * batch));
  core::Block out;
  Copies copies;
  std::vector<double> rate, copy_rate, ratio;
  for (int round = 0; round <= rounds; ++round) {
    double kernel = 0, copying = 0;
    for (const core::Shots& s : shots) {
      core::resize(out, 0);
      const auto a = Clock::now();
      if (g.run(s, out).georeferenced != s.size()) std::abort();
      const auto b = Clock::now();
      if (copies.columns.empty()) copies.fit(s, out);
      const auto c = Clock::now();
      copies.copy(s, out);
      kernel += seconds(a, b);
      copying += seconds(c, Clock::now());
    }
    if (round == 0) continue;  // patches of the map and pages are made
    const auto n = static_cast<double>(batch * batches_of_a_round);
    rate.push_back(n / kernel);
    copy_rate.push_back(n / copying);
    ratio.push_back(kernel / copying);
  }
  std::printf("%-32s %6.2f M returns/s   memcpy of the same %zu bytes/return %7.1f M returns/s   kernel/memcpy %5.1f\n", name,
              median(rate) / 1e6, copies.bytes / batch, median(copy_rate) / 1e6, median(ratio));
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 9;
  const trajectory::Trajectory t(flight());
  core::Scanner air;
  air.air = core::AirModel::ciddor;
  core::Scanner cone;
  cone.model = core::ScannerModel::conical;
  measure("mirror, with TPU", t, {}, true, rounds);
  measure("mirror, without TPU", t, {}, false, rounds);
  measure("mirror, with TPU and atmosphere", t, air, true, rounds);
  measure("conical, with TPU", t, cone, true, rounds);
}
