// SPDX-License-Identifier: GPL-3.0-or-later
// Deviation: roll, pitch and heading are added as they are, though the local axes turn by the move (1.6e-8 rad per 0.1 m).
#include "trajectory/corrected.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::trajectory {
namespace {

using Six = CorrectionSeries::Six;

bool finite(const Six& v) {
  return std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
}

void check(const CorrectionSeries& series, size_t number) {
  const std::string where = "correction " + std::to_string(number + 1);
  if (series.knots.empty()) throw core::Error("a stretch has no knots", where, "leave the stretch out");
  for (size_t k = 0; k < series.knots.size(); ++k) {
    const CorrectionSeries::Knot& knot = series.knots[k];
    if (!std::isfinite(knot.time) || !finite(knot.value) || (knot.sigma && !finite(*knot.sigma)))
      throw core::Error("knot " + std::to_string(k + 1) + " is not finite", where, "the adjustment that made it has failed");
    if (k > 0 && !(knot.time > series.knots[k - 1].time))
      throw core::Error("knot " + std::to_string(k + 1) + " is not later than the one before", where, "sort the knots by time");
  }
}

Six mix(const Six& a, const Six& b, double share) {
  Six out;
  for (size_t i = 0; i < 6; ++i) out[i] = (1 - share) * a[i] + share * b[i];
  return out;
}

}  // namespace

CorrectionCurve::CorrectionCurve(std::vector<CorrectionSeries> corrections) {
  for (size_t i = 0; i < corrections.size(); ++i) check(corrections[i], i);
  std::vector<size_t> order(corrections.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return corrections[a].knots.front().time < corrections[b].knots.front().time; });
  for (const size_t i : order) {
    const auto& knots = corrections[i].knots;
    if (!knots_.empty() && !(knots.front().time > knots_.back().time))
      throw core::Error("the stretch begins at " + core::format_number(knots.front().time) + " s, before another one's end at " +
                            core::format_number(knots_.back().time) + " s",
                        "correction " + std::to_string(i + 1), "cut the flight lines so that they do not overlap in time");
    knots_.insert(knots_.end(), knots.begin(), knots.end());
  }
}

CorrectionCurve::Value CorrectionCurve::at(double time) const {
  Value out;
  if (knots_.empty()) return out;
  const auto next = std::upper_bound(knots_.begin(), knots_.end(), time, [](double t, const auto& knot) { return t < knot.time; });
  if (next == knots_.begin() || next == knots_.end()) {
    const CorrectionSeries::Knot& end = next == knots_.begin() ? knots_.front() : knots_.back();
    out.value = end.value;
    out.sigma = end.sigma;
    return out;
  }
  const CorrectionSeries::Knot &a = *(next - 1), &b = *next;
  const double length = b.time - a.time, share = (time - a.time) / length;
  out.value = mix(a.value, b.value, share);
  for (size_t i = 0; i < 6; ++i) out.rate[i] = (b.value[i] - a.value[i]) / length;
  if (a.sigma && b.sigma) out.sigma = mix(*a.sigma, *b.sigma, share);
  return out;
}

namespace {

core::CalibrationResponse response_of(const std::vector<CorrectionSeries>& corrections) {
  std::vector<const CorrectionSeries::Knot*> knots;
  for (const CorrectionSeries& s : corrections)
    for (const CorrectionSeries::Knot& k : s.knots) {
      if (!k.response) return {};
      knots.push_back(&k);
    }
  std::sort(knots.begin(), knots.end(), [](const auto* a, const auto* b) { return a->time < b->time; });
  core::CalibrationResponse out;
  for (const CorrectionSeries::Knot* k : knots) {
    out.time.push_back(k->time);
    out.per_unit.push_back(*k->response);
  }
  return out;
}

}  // namespace

core::TrajectoryData corrected(const core::TrajectoryData& trajectory, const std::vector<CorrectionSeries>& corrections) {
  const CorrectionCurve curve(corrections);
  if (corrections.empty()) return trajectory;
  core::TrajectoryData out = trajectory;
  out.covariance = {};
  out.errors = {};
  out.response = response_of(corrections);
  for (size_t k = 0; k < out.size(); ++k) {
    const CorrectionCurve::Value c = curve.at(out.time[k]);
    const Eigen::Vector3d move(c.value[0], c.value[1], c.value[2]);
    const core::Geodetic from{out.latitude[k], out.longitude[k], out.height[k]};
    const core::Geodetic to = core::geodetic_of(core::ecef_of(from) + core::ecef_R_ned(from.latitude, from.longitude) * move);
    out.latitude[k] = to.latitude;
    out.longitude[k] = to.longitude;
    out.height[k] = to.height;
    out.roll[k] += c.value[3];
    out.pitch[k] += c.value[4];
    out.heading[k] = core::wrap_two_pi(out.heading[k] + c.value[5]);
    if (out.has_velocity()) {
      out.v_north[k] += c.rate[0];
      out.v_east[k] += c.rate[1];
      out.v_down[k] += c.rate[2];
    }
    if (!out.has_sigma() || !c.sigma) continue;
    size_t i = 0;
    for (auto* column : {&out.sigma_north, &out.sigma_east, &out.sigma_down, &out.sigma_roll, &out.sigma_pitch, &out.sigma_heading})
      (*column)[k] = static_cast<float>((*c.sigma)[i++]);
  }
  return out;
}

}  // namespace swath::trajectory
