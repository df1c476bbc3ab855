// SPDX-License-Identifier: GPL-3.0-or-later
// Where the scanner of a cloud without trajectory was, by the pulses that came back twice.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/area.h"
#include "core/block.h"

namespace swath::quality {

/// First and last return of one pulse, whose line leads to the scanner; plain data.
struct PulseSpan {
  double time = 0.0, x = 0.0, y = 0.0, z = 0.0;  ///< s; m, of the first on the map
  float dx = 0.0F, dy = 0.0F, dz = 0.0F;         ///< m, last less first: dz is negative
  std::int32_t line = 0;
};

/// A return of a pulse with several; plain data. On the map, s and m.
struct PulseReturn {
  double time = 0.0, x = 0.0, y = 0.0, z = 0.0;
  std::int32_t line = 0, number = 0;
};

/// Of the first `own` points the returns of pulses with several, in any of the boxes of map metres. Needs columns time, strip,
/// return_number, return_count; none without them.
std::vector<PulseReturn> pulse_returns_in(const core::Block& block, std::size_t own, const std::vector<core::Box>& boxes);
/// Pulses whose last return lies 3 m or more below the first, by line and time; returns in any order give the same.
std::vector<PulseSpan> spans_of(std::vector<PulseReturn> returns);

/// The scanner's place and motion around a time.
class ScannerTrack {
 public:
  /// From the spans of one line within track_window of the time. Nothing where fewer than 30 fit, or where they leave it open by more than
  /// 0.005 of the height.
  static std::optional<ScannerTrack> around(double time, const std::vector<PulseSpan>& spans);

  /// m that a beam of that time to a place p of the map runs east and north for each metre that it comes down.
  Eigen::Vector2d run(double time, const Eigen::Vector3d& p) const;
  double run_sigma() const { return sigma_; }  ///< of it, each component

 private:
  double time_ = 0.0, sigma_ = 0.0;
  Eigen::Vector3d at_ = Eigen::Vector3d::Zero();
  Eigen::Vector2d speed_ = Eigen::Vector2d::Zero();
};

constexpr double track_window = 2.5;  ///< s: the aircraft moves evenly for so long, to half a metre

}  // namespace swath::quality
