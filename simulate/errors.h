// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/records/sensor.h"
#include "simulate/flight.h"
#include "simulate/options.h"

namespace swath::simulate {

/// The errors of the delivered trajectory over time: a Gaussian process of the stated sigmas for each of north, east, up, roll, pitch,
/// heading, with an autocorrelation near exp(-|t| / correlation); smooth (no part faster than 0.5 Hz).
class TrajectoryErrors {
 public:
  TrajectoryErrors(const NoiseOptions& noise, std::int64_t seed);

  struct At {
    std::array<double, 6> value{}, rate{};  ///< m, rad; per second
  };
  At at(double t) const;
  /// North, east, up (m), roll, pitch, heading (rad); 0 where noise-free.
  const std::array<double, 6>& sigma() const { return sigma_; }

 private:
  struct Wave {
    double omega, cosine, sine;
  };
  std::array<double, 6> sigma_{};
  std::array<std::vector<Wave>, 6> waves_;
};

/// The motion as delivered: with the errors at t.
Motion delivered(const Motion& truth, const TrajectoryErrors::At& error);

/// The true calibration: the options' with what the seed draws.
core::Calibration true_calibration(const MountingOptions& mounting, std::int64_t seed);

/// What survey.toml states.
struct DeliveredCalibration {
  core::Calibration calibration;
  core::SensorSigma sigma;
};
/// Of a mounting whose truth is already drawn (true_calibration). `sigma` holds the stated sigmas of the single record too, with the
/// rounding to the resolutions (step / sqrt 12) inside.
DeliveredCalibration deliver_calibration(const MountingOptions& mounting, const NoiseOptions& noise, const ScannerOptions& scanner,
                                         std::int64_t seed);

}  // namespace swath::simulate
