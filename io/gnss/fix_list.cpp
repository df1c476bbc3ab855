// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/fix_list.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/error.h"
#include "core/geo/geodesy.h"
#include "core/statistics.h"
#include "io/survey/record_times.h"
#include "io/survey/wild_records.h"

namespace swath::io {
namespace {

using core::FixQuality;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double most_not_finite = 0.03, most_back = 0.03;
constexpr double most_repeated = 0.2;       // receivers repeat a fix now and then
constexpr double near_ground = 1e5;         // m
constexpr double lowest_antenna = -480.0;   // m, ellipsoidal: the shore of the Dead Sea is at -415
constexpr double fastest = 500.0;           // m/s
constexpr double near_one_another = 100.0;  // m: errors of single positions
constexpr double gap_steps = 1.5;
constexpr double unknown_sigma = 1e5;     // m or m/s: more says that it is not known
constexpr double least_variance = 1e-10;  // m^2 or (m/s)^2; less is a zero that went through rotations

/// Horizontal sigma that a solution of this kind has at least, m; its height has twice that.
double least_sigma(FixQuality q) {
  switch (q) {
    case FixQuality::ppp:
      return 0.1;
    case FixQuality::float_ambiguity:
      return 0.3;
    case FixQuality::differential:
    case FixQuality::sbas:
      return 1.0;
    case FixQuality::single:
      return 3.0;
    case FixQuality::fixed:
    case FixQuality::unknown:
      break;
  }
  return 0.0;
}

Matrix3d ecef_R_neu(double latitude, double longitude) {
  Matrix3d m = core::ecef_R_ned(latitude, longitude);
  m.col(2) *= -1;
  return m;
}

/// The largest sigma of a covariance; 0 where there is none.
double largest_sigma_of(const Matrix3d& covariance) {
  const Vector3d variances = covariance.diagonal();
  return variances.array().isNaN().any() ? 0.0 : std::sqrt(std::max(variances.maxCoeff(), 0.0));
}

/// What is impossible about a fix whose position is finite, and what to do; empty where nothing is.
std::pair<std::string, std::string> impossibility(const Fix& f) {
  if (!f.fault.empty()) return {f.fault, f.hint};
  const double height = core::geodetic_of(f.position).height;
  const std::string metres = core::format_number(std::round(height)) + " m";
  if (f.position.norm() < 0.5 * core::wgs84::b || std::abs(height) > near_ground)
    return {"the position is not near the ground: height " + metres, "check the columns and their units"};
  if (height < lowest_antenna)
    return {"the position lies below all land: height " + metres,
            "heights count up from the ellipsoid: those of this file may count down; correct their sign, or the columns"};
  return {};
}

}  // namespace

FixQuality quality_of_rtklib(double number) {
  constexpr FixQuality by_number[] = {FixQuality::unknown, FixQuality::fixed,        FixQuality::float_ambiguity,
                                      FixQuality::sbas,    FixQuality::differential, FixQuality::single,
                                      FixQuality::ppp};
  return number >= 0 && number <= 6 && number == std::floor(number) ? by_number[static_cast<size_t>(number)] : FixQuality::unknown;
}

Matrix3d ecef_covariance(const Matrix3d& neu, double latitude, double longitude) {
  const Matrix3d R = ecef_R_neu(latitude, longitude);
  return R * neu * R.transpose();
}

Vector3d ecef_vector(const Vector3d& neu, double latitude, double longitude) { return ecef_R_neu(latitude, longitude) * neu; }

FixList::FixList(const GnssFile& file, std::string name, double latency, bool may_go_back, core::Tally& tally)
    : file_(file), name_(std::move(name)), latency_(latency), may_go_back_(may_go_back), tally_(tally) {}

Matrix3d FixList::settled(const Matrix3d& covariance, const Matrix3d& R, const Vector3d& otherwise, const char* of, const Read& read) {
  const Matrix3d local = R.transpose() * covariance * R;
  const Vector3d variances = local.diagonal();
  if (!local.allFinite() || variances.minCoeff() < least_variance) {
    tally_.count(std::string("GNSS ") + of + " sigmas missing, zero or less: those of the survey are taken", place(read));
    return R * otherwise.asDiagonal() * R.transpose();
  }
  if (Eigen::LLT<Matrix3d>(local).info() == Eigen::Success) return covariance;
  tally_.count(std::string("GNSS ") + of + " covariances that are not positive definite: their variances alone are taken", place(read));
  return R * variances.asDiagonal() * R.transpose();
}

void FixList::leave_out_not_finite() {
  all_ = read_.size();
  std::optional<core::Error> first;
  std::uint64_t far = 0;
  std::erase_if(read_, [&](const Read& r) {
    const Fix& f = r.fix;
    if (f.fault.empty() && (!std::isfinite(f.time) || !f.position.allFinite())) {
      ++not_finite_;
      tally_.count("GNSS fixes with a value that is empty or not finite, left out", place(r));
      return true;
    }
    const auto [fault, hint] = impossibility(f);
    if (fault.empty()) {
      const bool unknown = largest_sigma_of(f.covariance) > unknown_sigma;
      if (!unknown) return false;
      ++without_sigma_;
      tally_.count("GNSS fixes with a sigma over 100 km, left out", place(r));
      return true;
    }
    ++far;
    tally_.count("GNSS fixes with an impossible position, left out", place(r) + ": " + fault);
    if (!first) first.emplace(fault, place(r), hint);
    return true;
  });
  if (far > 0 && !are_few(far, all_)) throw *first;
}

void FixList::set_times(const std::vector<double>& times) {
  for (size_t k = 0; k < read_.size(); ++k) read_[k].fix.time = times[k];
  std::erase_if(read_, [](const Read& r) { return std::isnan(r.fix.time); });
}

void FixList::leave_out_wild() {
  const auto leave_out = [&](const std::vector<size_t>& wild, const char* what) {
    if (wild.empty() || !are_few(wild.size(), all_)) return;
    size_t kept = 0;
    for (size_t k = 0, next = 0; k < read_.size(); ++k) {
      if (next < wild.size() && wild[next] == k) {
        ++next;
        tally_.count(what, place_of(k) + ": " + core::utc_text(read_[k].fix.time));
      } else if (kept++ != k) {
        read_[kept - 1] = std::move(read_[k]);
      }
    }
    read_.resize(kept);
  };
  std::vector<double> times;
  for (const Read& r : read_) times.push_back(r.fix.time);
  leave_out(wild_times(times), "GNSS fixes with an impossible time, left out");
  leave_out(contradicted(read_.size(),
                         [&](size_t i, size_t j) {
                           const Fix &a = read_[i].fix, &b = read_[j].fix;
                           return (a.position - b.position).norm() > near_one_another + fastest * std::abs(a.time - b.time);
                         }),
            "GNSS fixes far from those around them, left out");
}

void FixList::take(const Read& read) {
  const Fix& f = read.fix;
  const core::Geodetic g = core::geodetic_of(f.position);
  const double t = f.time + latency_;
  if (!out_.time.empty() && t < out_.time.back()) {
    if (!may_go_back_)
      throw core::Error("time goes back by " + core::format_number(out_.time.back() - t, 4) + " s", place(read),
                        "export the fixes in the order of time");
    ++back_;
    tally_.count("GNSS fixes whose time goes back, left out", place(read));
    return;
  }
  if (!out_.time.empty() && t == out_.time.back()) {
    ++repeated_;
    tally_.count("GNSS fixes at a repeated time, left out", place(read));
    return;
  }
  const double least = least_sigma(f.quality);
  const double horizontal = std::max(file_.sigma_horizontal.value, least), vertical = std::max(file_.sigma_vertical.value, 2 * least);
  const Vector3d variances(horizontal * horizontal, horizontal * horizontal, vertical * vertical);
  const Matrix3d R = ecef_R_neu(g.latitude, g.longitude);
  const bool own = !f.covariance.array().isNaN().all();
  (own ? own_sigmas_ : lent_sigmas_) = true;
  out_.time.push_back(t);
  out_.position.push_back(f.position);
  out_.covariance.push_back(own ? settled(f.covariance, R, variances, "position", read)
                                : Matrix3d(R * variances.asDiagonal() * R.transpose()));
  const double v = file_.sigma_velocity.value;
  const Vector3d velocity_variances = Vector3d::Constant(v * v);
  bool moves = f.velocity.allFinite();
  if (moves && largest_sigma_of(f.velocity_covariance) > unknown_sigma) {
    tally_.count("GNSS velocities with a sigma over 100 km/s, left out", place(read));
    moves = false;
  }
  velocities_ = velocities_ || moves;
  out_.velocity.push_back(moves ? f.velocity : Vector3d(Vector3d::Constant(Fix::none)));
  const bool own_velocity = moves && !f.velocity_covariance.array().isNaN().all();
  out_.velocity_covariance.push_back(own_velocity ? settled(f.velocity_covariance, R, velocity_variances, "velocity", read)
                                                  : Matrix3d(velocity_variances.asDiagonal()));
  out_.quality.push_back(f.quality);
  out_.satellites.push_back(static_cast<std::uint8_t>(f.satellites >= 0 ? std::min(f.satellites, 255.0) : 0.0));
}

core::GnssData FixList::finish() {
  leave_out_not_finite();
  leave_out_wild();
  for (const Read& r : read_) take(r);
  const auto refuse = [&](std::uint64_t n, double most, const char* what, const char* hint) {
    if (static_cast<double>(n) > most * static_cast<double>(all_))
      throw core::Error(std::to_string(n) + " of " + std::to_string(all_) + " fixes " + what, name_, hint);
  };
  refuse(not_finite_, most_not_finite, "have a value that is empty or not finite", "check the columns, or export again");
  refuse(repeated_, most_repeated, "are at the time of the fix before",
         "times too coarse (export them with more digits), or each fix written twice (keep one)");
  refuse(back_, most_back, "go back in time", "the file holds several sessions: part them, or sort it");
  tally_.read("GNSS fixes", added_);
  tally_.keep("GNSS fixes", out_.size());
  if (out_.size() == 0 && without_sigma_ > 0)
    throw core::Error("every fix has a sigma over 100 km", name_, "check the sigmas' columns and their units");
  if (out_.size() == 0) throw core::Error("the file has no position", name_, "check its format and columns");
  if (!velocities_) {
    out_.velocity.clear();
    out_.velocity_covariance.clear();
  }
  note_date(out_.time.front(), name_, tally_);
  if (lent_sigmas_)
    tally_.count(own_sigmas_ ? "GNSS files with fixes without sigmas of their own: those of the survey taken"
                             : "GNSS files without sigmas of their own: those of the survey taken",
                 name_);
  std::map<FixQuality, std::uint64_t> by;
  for (const FixQuality q : out_.quality) ++by[q];
  for (const auto& [q, n] : by) tally_.count("GNSS fixes: " + std::string(core::Choices<FixQuality>::names[static_cast<size_t>(q)]), n);
  std::vector<double> steps, from, to;
  for (size_t k = 1; k < out_.size(); ++k) steps.push_back(out_.time[k] - out_.time[k - 1]);
  const double step = core::median(steps);
  for (size_t k = 1; k < out_.size(); ++k) {
    if (steps[k - 1] > gap_steps * step) {
      from.push_back(out_.time[k - 1]);
      to.push_back(out_.time[k]);
    }
    const double speed = (out_.position[k] - out_.position[k - 1]).norm() / steps[k - 1];
    if (speed > fastest)
      tally_.count("GNSS fixes farther from the one before than 500 m/s make",
                   core::utc_text(out_.time[k]) + ": " + core::format_number(std::round(speed)) + " m/s");
  }
  count_gaps(from, to, "GNSS gaps", tally_);
  return std::move(out_);
}

}  // namespace swath::io
