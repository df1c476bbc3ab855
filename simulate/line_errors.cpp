// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/line_errors.h"

#include <cmath>

#include "simulate/random.h"

namespace swath::simulate {
namespace {

constexpr double fade = 10.0;  // s

/// What an error at one instant is made of: shares of a line's shift and drift, and their derivatives by time.
struct Share {
  size_t line;
  double shift, shift_rate, drift, drift_rate;
};

// Polynomials of degree 5 on [0, 1]: value 1 and slope 1 at 0, everything else of value, slope and curvature 0 at both ends.
double value_part(double u) { return 1 + u * u * u * (-10 + u * (15 - 6 * u)); }
double value_part_rate(double u) { return -30 * u * u * (1 - u) * (1 - u); }
double slope_part(double u) { return u * (1 + u * u * (-6 + u * (8 - 3 * u))); }
double slope_part_rate(double u) { return 1 + u * u * (-18 + u * (32 - 15 * u)); }

/// Of a line whose end (side = 1) or start (side = -1) lies `since` seconds away, in a gap of `gap` seconds.
Share in_gap(size_t index, const Line& line, double side, double since, double gap) {
  const double u = since / gap, per_line = gap / (line.end - line.start);
  return {index, value_part(u), side * value_part_rate(u) / gap, side * (0.5 * value_part(u) + per_line * slope_part(u)),
          (0.5 * value_part_rate(u) + per_line * slope_part_rate(u)) / gap};
}

Share outside(size_t index, const Line& line, double side, double since) {
  const double length = line.end - line.start, s = std::tanh(since / fade);
  return {index, 1.0, 0.0, side * (0.5 + fade / length * s), (1 - s * s) / length};
}

}  // namespace

LineErrors::LineErrors(const NoiseOptions& noise, const std::vector<Line>& lines, std::int64_t seed) : lines_(lines) {
  if (noise.noise_free) return;
  for (size_t k = 0; k < 6; ++k) {
    shift_[k] = k < 3 ? noise.line_shift.value : noise.line_attitude.value;
    drift_[k] = k < 3 ? noise.line_drift.value : noise.line_attitude_drift.value;
  }
  draws_.resize(lines.size());
  for (size_t i = 0; i < lines.size(); ++i) {
    Random random = random_of(seed, Stream::line_errors, static_cast<std::uint64_t>(lines[i].id));
    for (size_t k = 0; k < 6; ++k) {
      draws_[i].shift[k] = shift_[k] * random.normal();
      draws_[i].drift[k] = drift_[k] * random.normal();
    }
  }
}

LineErrors::At LineErrors::at(double t) const {
  At out;
  if (draws_.empty()) return out;
  size_t i = 0;  // the last line that has begun, or the first
  while (i + 1 < lines_.size() && lines_[i + 1].start <= t) ++i;
  const Line& line = lines_[i];
  std::array<Share, 2> shares{};
  size_t n = 1;
  if (t < line.start) {
    shares[0] = outside(i, line, -1.0, line.start - t);
  } else if (t <= line.end) {
    const double length = line.end - line.start;
    shares[0] = {i, 1.0, 0.0, (t - line.start) / length - 0.5, 1.0 / length};
  } else if (i + 1 == lines_.size()) {
    shares[0] = outside(i, line, 1.0, t - line.end);
  } else {
    const Line& next = lines_[i + 1];
    const double gap = next.start - line.end;
    shares[0] = in_gap(i, line, 1.0, t - line.end, gap);
    shares[1] = in_gap(i + 1, next, -1.0, next.start - t, gap);
    n = 2;
  }
  for (size_t k = 0; k < 6; ++k) {
    double variance = 0.0;
    for (size_t s = 0; s < n; ++s) {
      const Share& w = shares[s];
      const Draw& d = draws_[w.line];
      out.value[k] += w.shift * d.shift[k] + w.drift * d.drift[k];
      out.rate[k] += w.shift_rate * d.shift[k] + w.drift_rate * d.drift[k];
      variance += std::pow(w.shift * shift_[k], 2) + std::pow(w.drift * drift_[k], 2);
    }
    out.sigma[k] = std::sqrt(variance);
  }
  return out;
}

}  // namespace swath::simulate
