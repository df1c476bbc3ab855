// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/station_drift.h"

#include <cmath>

namespace swath::calib {
namespace {

struct LineSums {
  size_t n = 0;
  double t0 = 0.0, t = 0.0, tt = 0.0, d = 0.0, dd = 0.0, td = 0.0;  // times from t0

  void add(double time, double difference) {
    if (n == 0) t0 = time;
    const double x = time - t0;
    ++n, t += x, tt += x * x, d += difference, dd += difference * difference, td += x * difference;
  }
  double mean() const { return d / static_cast<double>(n); }
  DriftLine line() const {
    DriftLine out;
    const auto count = static_cast<double>(n);
    const double determinant = count * tt - t * t;
    out.stations = n;
    if (determinant > 0.0) out.a1 = (count * td - t * d) / determinant;
    out.a0 = (d - out.a1 * t) / count - out.a1 * t0;
    return out;
  }
};

void measure(const StripDifferences& s, DriftLine& line, double mean) {
  for (size_t i = 0; i < s.time.size(); ++i) {
    line.direct += std::pow(s.difference[i], 2);
    line.less_mean += std::pow(s.difference[i] - mean, 2);
    line.less_line += std::pow(s.difference[i] - line.a0 - line.a1 * s.time[i], 2);
  }
}

void to_rms(DriftLine& line) {
  for (double* v : {&line.direct, &line.less_mean, &line.less_line}) *v = std::sqrt(*v / static_cast<double>(line.stations));
}

}  // namespace

DriftFound drift_of(const std::string& coordinate, const std::vector<StripDifferences>& strips) {
  DriftFound out;
  out.coordinate = coordinate;
  LineSums all;
  for (const StripDifferences& s : strips)
    for (size_t i = 0; i < s.time.size(); ++i) all.add(s.time[i], s.difference[i]);
  if (all.n == 0) return out;
  out.together = all.line();
  double squares = 0.0;
  for (const StripDifferences& s : strips) {
    if (s.time.empty()) continue;
    LineSums own;
    for (size_t i = 0; i < s.time.size(); ++i) own.add(s.time[i], s.difference[i]);
    DriftLine line = own.line();
    line.strip = s.strip;
    measure(s, line, own.mean());
    measure(s, out.together, own.mean());
    squares += line.less_line;
    to_rms(line);
    out.strips.push_back(line);
  }
  to_rms(out.together);
  out.less_lines = std::sqrt(squares / static_cast<double>(all.n));
  return out;
}

}  // namespace swath::calib
