// SPDX-License-Identifier: GPL-3.0-or-later
// A phase-locked loop of second order with critical damping (Mills 1991, "Internet time synchronization", without its clock filter and
// selection): after each measured offset the clock is slewed by offset / T per second and its frequency correction grows by
// offset poll / (4 T^2). A frequency error f then decays as f t exp(-t / 2T); with `settling` = 13.3 T a frequency error of 15 ppm is
// down to 19 us after `settling` = 1000 s. Jitter and wander: running means of squares with the weight 1/4 (RFC 5905, A.5.5.6).
#include "simulate/files/computer_clock.h"

#include <algorithm>
#include <cmath>

#include "simulate/random.h"

namespace swath::simulate {

ComputerClock::ComputerClock(const ClockOptions& o, double duration, std::int64_t seed) : begin_(-o.before.value), poll_(o.poll_seconds()) {
  const double T = o.settling.value / 13.3;
  constexpr double weight = 0.25, hour = 3600.0;
  const auto blend = [](double mean, double value) { return std::sqrt(mean * mean + weight * (value * value - mean * mean)); };
  Random random = random_of(seed, Stream::clock);
  double clock = o.offset.value, hardware = o.frequency.value, correction = 0.0;
  double last_offset = 0.0, jitter = o.jitter.value, wander = 0.0;
  for (int k = 0;; ++k) {
    const double t = begin_ + k * poll_;
    const double offset = -clock + o.jitter.value * random.normal();
    if (k > 0) jitter = blend(jitter, offset - last_offset);
    last_offset = offset;
    const double change = offset * poll_ / (4 * T * T);
    correction += change;
    wander = blend(wander, change);
    updates_.push_back({t, clock, offset, correction, jitter, wander});
    if (t > duration) break;
    clock += poll_ * (hardware + correction + offset / T);
    hardware += o.wander.value * std::sqrt(poll_ / hour) * random.normal();
  }
}

double ComputerClock::offset(double t) const {
  const double k = std::clamp(std::floor((t - begin_) / poll_), 0.0, static_cast<double>(updates_.size() - 2));
  const Update &a = updates_[static_cast<size_t>(k)], &b = updates_[static_cast<size_t>(k) + 1];
  return a.clock + (b.clock - a.clock) * (t - a.t) / poll_;
}

}  // namespace swath::simulate
