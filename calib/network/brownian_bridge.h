// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace swath::calib {

/// Variance of a weighted sum of a Brownian motion's departures from the straight lines between instants, per unit of its spectral density:
/// covariance dt s (1 - s') within an interval of dt, s before s' as shares of it. Times must rise.
struct BrownianBridge {
  double sum = 0.0, before = 0.0;
  int interval = -1;
  void add(int k, double dt, double s, double weight) {
    if (k != interval) interval = k, before = 0.0;
    sum += dt * weight * (1.0 - s) * (2.0 * before + weight * s);
    before += weight * s;
  }
};

}  // namespace swath::calib
