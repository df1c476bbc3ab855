// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/prepared_flight.h"

#include <algorithm>
#include <cmath>

#include "calib/ties/control.h"
#include "core/error.h"
#include "io/vector/control.h"

namespace swath::calib {
namespace {

double metres_down(const std::vector<FlownLine>& lines) {
  double sum = 0, n = 0;
  for (const FlownLine& l : lines)
    if (std::isfinite(l.height)) sum += l.height, n += 1;
  return n > 0 ? sum / n : 0.0;
}

/// The lines of the flight; what is wrong with them is counted, or refused.
std::vector<FlownLine> fly(const CalibrationFlight& flight, core::Tally& tally) {
  const ShotGeometry geometry(flight.scanner, flight.start);
  FlownLines flown(geometry, *flight.trajectory);
  flight.shots([&](int line, const core::Shots& shots) { flown.add(line, shots); });
  std::vector<FlownLine> lines = flown.lines();
  for (const Finding& f : check_lines(lines)) {
    if (f.refuses) throw core::Error(f.what, "laser records", f.cure);
    tally.count(f.what + " (" + f.cure + ")");
  }
  return lines;
}

}  // namespace

PreparedFlight::PreparedFlight(const io::Survey& survey, ShotStream shots, int threads, const trajectory::Trajectory& flown,
                               const trajectory::ErrorModelOptions& options, core::Tally& tally)
    : errors(flown.data(), options) {
  flight.shots = std::move(shots);
  flight.scanner = survey.scanner;
  flight.start = survey.calibration;
  flight.sensor = survey.sigma;
  flight.trajectory = &flown;
  flight.errors = &errors;
  flight.threads = threads;
  lines = fly(flight, tally);
  std::vector<std::pair<double, double>> times;
  for (const FlownLine& l : lines) times.emplace_back(l.first, l.last);
  const double height = metres_down(lines), side = side_for(lines, 1.0);
  flight.frame = frame_of(times, height, flown);
  flight.scale = scale_of(height, side > 0.0 ? 1.0 / (side * side) : 0.0, survey.sigma);
  for (const auto& [first, last] : times) flight.scale.seconds += last - first;
  flight.targets = surveyed_targets(io::read_control(survey, tally), flight.frame, tally);
}

double PreparedFlight::cell() const {
  constexpr double returns = 12, step = 0.5;
  return std::max(step, step * std::ceil(side_for(lines, returns) / step));
}

}  // namespace swath::calib
