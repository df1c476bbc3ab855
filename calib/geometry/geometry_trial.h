// SPDX-License-Identifier: GPL-3.0-or-later
// Mistakes tried on a sample of a flight whose geometry does not hold together.
#pragma once

#include <vector>

#include "calib/geometry/geometry_figures.h"
#include "calib/geometry/small_mistakes.h"

namespace swath::calib {

/// What is sampled: times shifted by `shift`, s; swaths as wide as `range` makes them, m.
struct SampleFor {
  double shift = 0.0, range = 0.0;
};
/// The shots are read once for all. Samples for several assumptions have fewer stretches between lines, about twice the flight's own in
/// all; each has as many profiles and stretches at control as the flight's.
std::vector<SampledFlight> sampled(const GeometryInput& input, const GeometryOptions& options, const trajectory::LocalFrame& frame,
                                   const std::vector<SampleFor>& wanted);

size_t not_held(const std::vector<GeometryCheck>& checks);
/// GPS less UTC at the flight's date, s.
double leap_seconds(const GeometryInput& input);

/// Input, options, flight, figures and `mistakes`, the usual ones, must outlive it.
class Trial {
 public:
  Trial(const GeometryInput& input, const GeometryOptions& options, const SampledFlight& flight, const GeometryFigures& found,
        const std::vector<UsualMistake>& mistakes);

  /// All usual mistakes but those of the ranges.
  void usual(std::vector<TriedMistake>& out) const;
  /// Those that need a sample of their own: ranges, whose swaths have another width, and leap seconds; then the offset of the laser's times
  /// that the roll shows. The shots are read four times at most.
  void sampled_anew(std::vector<TriedMistake>& out) const;
  /// Leap seconds alone.
  void leap(std::vector<TriedMistake>& out) const;
  /// Small offsets of the laser's times, and values of calibration fitted to the lines' differences.
  void fitted(std::vector<TriedMistake>& out) const;
  /// A small mistake, as it was found by explain_small().
  TriedMistake judged(const SmallExplanation& mistake) const;

 private:
  Chain later(double offset) const;
  std::uint64_t enough() const;
  void follow(SampledFlight flight, double centre, int samples, std::vector<TriedMistake>& out) const;
  TriedMistake offset_of(const SampledFlight& flight, const char* name, double offset) const;
  void judge(const SampledFlight& flight, const Chain& chain, const trajectory::Trajectory& t, const core::TrajectoryData& whole,
             size_t motion, TriedMistake& out) const;

  const GeometryInput& in_;
  const GeometryOptions& options_;
  const SampledFlight& flight_;
  const GeometryFigures& found_;
  const std::vector<UsualMistake>& mistakes_;
  double shift_;
  core::TrajectoryData piece_, whole_;
  trajectory::TrajectoryOptions how_;
  size_t motion_ = 0;
};

}  // namespace swath::calib
