// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: cross-correlation, then least squares, as usual in integrating sensors (Skog, Haendel 2011, "Time synchronization errors in
// loosely coupled GPS-aided inertial navigation systems"); weights: Huber (1981); variance of a sum of correlated terms: Geyer (1992),
// "Practical Markov chain Monte Carlo", initial monotone sequence.
#include "trajectory/clock/latency.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/statistics.h"
#include "trajectory/clock/motion_curve.h"

namespace swath::trajectory {
namespace {

using Eigen::Vector3d;
using Normal = Eigen::Matrix4d;  // latency and three shifts
using Vector4 = Eigen::Vector4d;

constexpr double latency_huber = 2.5;
constexpr size_t fewest = 20;              // common instants
constexpr size_t most_grid = 20000;        // instants of the cross-correlation
constexpr double speed_base = 1.0;         // s over which speed is differenced
constexpr double worth_correlating = 0.5;  // a lower peak is noise
constexpr double inflated = 100.0, hopeless = 1e6;
constexpr int latency_rounds = 30, common_rounds = 6;
constexpr double weakest = 0.3;  // share of the derivative's energy that is motion, not noise

/// Speed on a grid of time; NaN outside.
std::vector<Vector3d> signal_of(const MotionCurve& curve, bool places, double start, double step, size_t n, double base) {
  std::vector<Vector3d> out(n, Vector3d::Constant(std::nan("")));
  Vector3d a, b, unused;
  for (size_t i = 0; i < n; ++i) {
    const double t = start + step * static_cast<double>(i);
    if (!places) {
      if (curve.at(t, a, unused)) out[i] = a;
    } else if (curve.at(t - 0.5 * base, a, unused) && curve.at(t + 0.5 * base, b, unused)) {
      out[i] = Vector3d((b - a).norm() / base, 0, 0);
    }
  }
  return out;
}

/// Peak of the normalised cross-correlation within +-search.
void correlate(const Motion& reference, const Motion& device, bool places, double search, LatencyResult& out) {
  const double start = std::max(reference.time.front(), device.time.front()) - search;
  const double length = std::min(reference.time.back(), device.time.back()) + search - start;
  if (!(length > 2 * search)) return;
  const double slowest = std::max(core::median_step(reference.time), core::median_step(device.time));
  const double step = std::max({length / static_cast<double>(most_grid), std::min(slowest, search / 10), search / 1000});
  const auto n = static_cast<size_t>(length / step) + 1;
  const double base = std::max(speed_base, 2 * slowest);
  const auto a = signal_of(MotionCurve(reference), places, start, step, n, base),
             b = signal_of(MotionCurve(device), places, start, step, n, base);
  const auto lags = static_cast<long>(search / step);
  std::vector<double> r(static_cast<size_t>(2 * lags + 1), -1.0);
  for (long lag = -lags; lag <= lags; ++lag) {
    Vector3d sa = Vector3d::Zero(), sb = sa;
    double aa = 0, bb = 0, ab = 0, m = 0;
    for (long i = std::max(0L, -lag); i < static_cast<long>(n) && i + lag < static_cast<long>(n); ++i) {
      const Vector3d &x = a[static_cast<size_t>(i + lag)], &y = b[static_cast<size_t>(i)];
      if (!std::isfinite(x.x()) || !std::isfinite(y.x())) continue;
      sa += x;
      sb += y;
      aa += x.squaredNorm();
      bb += y.squaredNorm();
      ab += x.dot(y);
      ++m;
    }
    if (m < static_cast<double>(fewest)) continue;
    const double va = aa - sa.squaredNorm() / m, vb = bb - sb.squaredNorm() / m;
    if (va > 0 && vb > 0) r[static_cast<size_t>(lag + lags)] = (ab - sa.dot(sb) / m) / std::sqrt(va * vb);
  }
  const auto peak = std::max_element(r.begin(), r.end());
  if (*peak < worth_correlating) return;
  out.correlation = *peak;
  out.coarse = step * static_cast<double>(peak - r.begin() - lags);
}

/// One instant's equation per axis: residual = (d value / d latency) dL + shift.
struct Equation {
  Vector3d residual;      // device minus reference
  Vector3d rate;          // of the reference, from differences over a base: little noise
  Vector3d local_rate;    // the cubic's own: its noise is another
  Eigen::Matrix3d track;  // columns along, across, up
};

std::vector<Equation> equations(const MotionCurve& reference, const Motion& device, double latency, double base) {
  std::vector<Equation> out;
  Equation e;
  Vector3d value, before, after, unused;
  for (size_t i = 0; i < device.time.size(); ++i) {
    const double t = device.time[i] + latency;
    if (!reference.at(t, value, e.local_rate) || !reference.at(t - 0.5 * base, before, unused) ||
        !reference.at(t + 0.5 * base, after, unused))
      continue;
    e.rate = (after - before) / base;
    e.residual = device.value[i] - value;
    const double speed = e.rate.norm();
    const Vector3d along = speed > 0 ? Vector3d(e.rate / speed) : Vector3d::UnitX();
    const Vector3d across = along.cross(std::abs(along.z()) < 0.9 ? Vector3d::UnitZ() : Vector3d::UnitX()).normalized();
    e.track << along, across, along.cross(across);
    out.push_back(e);
  }
  return out;
}

Eigen::Matrix<double, 3, 4> jacobian(const Equation& e, LatencyShift shift) {
  Eigen::Matrix<double, 3, 4> j = Eigen::Matrix<double, 3, 4>::Zero();
  j.col(0) = e.rate;
  if (shift == LatencyShift::axes) j.rightCols<3>().setIdentity();
  if (shift == LatencyShift::track) j.rightCols<3>() = e.track;
  return j;
}

struct Solution {
  double latency = 0.0, cost = 0.0;
  Vector3d shift = Vector3d::Zero(), scale = Vector3d::Ones();
  std::vector<Equation> rows;
};

double weight_of(double residual, double scale) {
  const double z = std::abs(residual) / scale;
  return z > latency_huber ? latency_huber / z : 1.0;
}

/// Inverse of the normal matrix; parameters that are not estimated stay zero. Nothing where it is singular.
std::optional<Normal> inverse(const Normal& n, LatencyShift shift) {
  if (shift == LatencyShift::none) {
    if (!(n(0, 0) > 0)) return std::nullopt;
    Normal out = Normal::Zero();
    out(0, 0) = 1 / n(0, 0);
    return out;
  }
  Vector4 scale = n.diagonal();
  if (!(scale.minCoeff() > 0)) return std::nullopt;
  scale = scale.cwiseSqrt().cwiseInverse();
  const Eigen::FullPivLU<Normal> lu(scale.asDiagonal() * n * scale.asDiagonal());
  if (lu.rcond() < 1e-13) return std::nullopt;
  return Normal(scale.asDiagonal() * lu.inverse() * scale.asDiagonal());
}

Normal normal_of(const Solution& s, LatencyShift shift, Vector4* right = nullptr) {
  Normal n = Normal::Zero();
  if (right) right->setZero();
  for (const Equation& e : s.rows) {
    const auto j = jacobian(e, shift);
    const Vector3d left = e.residual - j.rightCols<3>() * s.shift;
    for (int a = 0; a < 3; ++a) {
      const double w = weight_of(left[a], s.scale[a]) / (s.scale[a] * s.scale[a]);
      n += w * j.row(a).transpose() * j.row(a);
      if (right) *right += w * left[a] * j.row(a).transpose();
    }
  }
  return n;
}

void measure(Solution& s, LatencyShift shift) {
  for (int a = 0; a < 3; ++a) {
    std::vector<double> left;
    for (const Equation& e : s.rows) left.push_back(std::abs((e.residual - jacobian(e, shift).rightCols<3>() * s.shift)[a]));
    s.scale[a] = std::max(core::mad_to_sigma * core::median(std::move(left), 0.0), 1e-12);
  }
  s.cost = s.scale.array().log().sum();
}

std::optional<Solution> solve(const MotionCurve& reference, const Motion& device, LatencyShift shift, double start, double search,
                              double base) {
  Solution s;
  s.latency = start;
  for (int round = 0; round < latency_rounds; ++round) {
    s.rows = equations(reference, device, s.latency, base);
    if (s.rows.size() < fewest) return std::nullopt;
    measure(s, shift);
    // Far from the answer the axis of flight shows it alone; the others' small residuals must not outweigh it.
    if (round < common_rounds) s.scale.setConstant(s.scale.maxCoeff());
    Vector4 right;
    const auto inv = inverse(normal_of(s, shift, &right), shift);
    if (!inv) return std::nullopt;
    const Vector4 step = *inv * right;
    s.latency += std::clamp(step[0], -search, search);
    s.shift += step.tail<3>();
    if (std::abs(s.latency) > 3 * search) return s;
    if (round >= common_rounds && std::abs(step[0]) < 1e-4 * std::sqrt((*inv)(0, 0)) + 1e-12) break;
  }
  s.rows = equations(reference, device, s.latency, base);
  if (s.rows.size() < fewest) return std::nullopt;
  measure(s, shift);
  return s;
}

/// How the residuals really answer to the latency, against the derivative over the base: one, less where that is noise, more where the
/// motion is quicker than the base.
double motion_share(const Solution& s) {
  double cross = 0, square = 0;
  for (const Equation& e : s.rows) {
    const Vector3d weighted = e.rate.cwiseQuotient(s.scale.cwiseAbs2());
    cross += weighted.dot(e.local_rate);
    square += weighted.dot(e.rate);
  }
  return square > 0 ? cross / square : 0.0;
}

/// Variance of the sum of correlated terms, whose sum an adjustment has made zero: the covariances over M lags are then too small by about
/// (2 M + 1) / n of their sum.
double variance_of_sum(const std::vector<double>& v) {
  const size_t n = v.size();
  const auto covariance = [&](size_t lag) {
    double c = 0;
    for (size_t i = lag; i < n; ++i) c += v[i] * v[i - lag];
    return c;
  };
  double sum = -covariance(0), before = 0;
  size_t lags = 0;
  for (size_t m = 0; 2 * m + 1 < n / 4; ++m) {
    double pair = covariance(2 * m) + covariance(2 * m + 1);
    if (pair <= 0) break;
    if (m > 0) pair = std::min(pair, before);
    before = pair;
    sum += 2 * pair;
    lags = 2 * m + 1;
  }
  const double lost = static_cast<double>(2 * lags + 1) / static_cast<double>(n);
  return std::max(sum, covariance(0) * 0.1) / std::max(1 - lost, 0.25);
}

/// How much a shift, estimated beside it, would inflate the variance of the latency.
double inflation(const Solution& s, LatencyShift shift) {
  Normal n = Normal::Zero();
  for (const Equation& e : s.rows) {
    const auto j = jacobian(e, shift);
    for (int a = 0; a < 3; ++a) n += j.row(a).transpose() * j.row(a) / (s.scale[a] * s.scale[a]);
  }
  const auto inv = inverse(n, shift);
  return inv && (*inv)(0, 0) > 0 ? std::min(n(0, 0) * (*inv)(0, 0), hopeless) : hopeless;
}

/// What each instant's residual adds to the latency, s; rms and outliers of the residuals.
std::vector<double> pulls_of(const Solution& s, const Normal& inv, LatencyShift shift, LatencyResult& out) {
  std::vector<double> pull;
  for (const Equation& e : s.rows) {
    const auto j = jacobian(e, shift);
    const Vector3d left = e.residual - j.rightCols<3>() * s.shift;
    double sum = 0, lowest = 1;
    for (int a = 0; a < 3; ++a) {
      const double w = weight_of(left[a], s.scale[a]);
      sum += w / (s.scale[a] * s.scale[a]) * left[a] * (inv.row(0) * j.row(a).transpose())(0);
      lowest = std::min(lowest, w);
    }
    pull.push_back(sum);
    out.outliers += lowest < 0.5;
    out.rms += left.cwiseAbs2() / static_cast<double>(s.rows.size());
  }
  out.rms = out.rms.cwiseSqrt();
  return pull;
}

LatencyResult estimate(const Motion& raw_reference, const Motion& raw_device, const LatencyOptions& o, bool places) {
  LatencyResult out;
  const auto no = [&](const char* why) {
    out.reason = why;
    out.determinable = false;
    out.sigma = 0;
    return out;
  };
  if (raw_reference.time.size() < fewest || raw_device.time.size() < fewest) return no("too few records");
  const Motion reference = averaged(raw_reference, o.smoothing.value), device = averaged(raw_device, o.smoothing.value);
  const double search = o.search.value;
  const LatencyShift shift = places || o.shift == LatencyShift::none ? o.shift : LatencyShift::axes;
  correlate(reference, device, places, search, out);
  const MotionCurve curve(reference);
  const double base = std::max(places ? speed_base : 0.0, 2 * (o.smoothing.value + 2.5 * core::median_step(reference.time)));
  std::optional<Solution> best;
  for (const double start : {out.coarse, 0.0}) {
    const std::optional<Solution> s = solve(curve, device, shift, start, search, base);
    if (s && (!best || s->cost < best->cost)) best = s;
  }
  if (!best) {
    if (equations(curve, device, out.coarse, base).size() < fewest) return no("the records have too few instants in common");
    return no("a latency and a constant shift are alike in this motion: vary speed or direction, or estimate no shift");
  }
  const Solution& s = *best;
  out.latency = s.latency;
  out.used = s.rows.size();
  const Normal n = normal_of(s, shift);
  const auto inv = inverse(n, shift);
  if (!inv) return no("a latency and a constant shift are alike in this motion: vary speed or direction, or estimate no shift");
  const double share = motion_share(s);
  out.sigma = std::sqrt(variance_of_sum(pulls_of(s, *inv, shift, out))) / std::max(share, weakest);
  for (size_t a = 0; a < 3; ++a) out.shift[a] = s.shift[static_cast<Eigen::Index>(a)];
  out.axes_inflation = inflation(s, LatencyShift::axes);
  out.track_inflation = places ? inflation(s, LatencyShift::track) : out.axes_inflation;
  const double own = shift == LatencyShift::none ? 1.0 : shift == LatencyShift::axes ? out.axes_inflation : out.track_inflation;
  if (std::abs(out.latency) > search) return no("the best latency lies beyond the search");
  if (own > 1e4) return no("a latency and a constant shift are alike in this motion: vary speed or direction, or estimate no shift");
  if (!(out.sigma < search / 3) || share < weakest) return no("the motion is too weak against the records' noise");
  out.determinable = true;
  if (shift == LatencyShift::none && places && out.axes_inflation > inflated)
    out.reason = "straight flight at one speed: a constant shift of the device along the track reads as latency";
  else if (shift == LatencyShift::none && places && out.track_inflation > inflated)
    out.reason = "one speed: another point of the carrier, before or behind the reference, reads as latency";
  return out;
}

}  // namespace

LatencyResult latency_of_places(const Motion& reference, const Motion& device, const LatencyOptions& options) {
  return estimate(reference, device, options, true);
}

LatencyResult latency_of_rates(const Motion& reference, const Motion& device, const LatencyOptions& options) {
  return estimate(reference, device, options, false);
}

Motion places_of(const std::vector<double>& time, const std::vector<Vector3d>& place, const Vector3d& origin, double epoch) {
  const core::Geodetic g = core::geodetic_of(origin);
  const Eigen::Matrix3d ned_R_ecef = core::ecef_R_ned(g.latitude, g.longitude).transpose();
  Motion out;
  for (size_t i = 0; i < time.size(); ++i) {
    if (!place[i].allFinite()) continue;
    out.time.push_back(time[i] - epoch);
    out.value.push_back(ned_R_ecef * (place[i] - origin));
  }
  return out;
}

}  // namespace swath::trajectory
