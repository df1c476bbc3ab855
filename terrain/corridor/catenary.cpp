// SPDX-License-Identifier: GPL-3.0-or-later
// The catenary of a wire of even weight (McLaughlin 2006, eq. 3) as
//   z(s) = level + (cosh(kappa u + t) - cosh t) / kappa,  u = s - at,  t = asinh(slope),
// fitted by Gauss-Newton with rejection of gross errors (Mikhail 1976), with a height and a tilt of each flight line. An error of the roll
// by e tilts a wire across the line by e; a place wrong by d along the wire is a tilt of d / a. Deviation: below kappa u = 1e-3 the first
// terms of its series are taken (relative error below 1e-12).
#include "terrain/corridor/catenary.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/statistics.h"

namespace swath::terrain {
namespace {

constexpr double series_below = 1e-3;     // of kappa u
constexpr double rejected_beyond = 3.5;   // robust sigmas
constexpr double finest_sigma = 0.002;    // m: returns are not written finer
constexpr size_t fewest_of_line = 8;      // returns of a flight line with an offset of its own
constexpr double shortest_tilted = 30.0;  // m that a flight line with a tilt of its own sees of the wire
constexpr int rounds = 12;

/// Offsets and tilts of flight lines: which column of the design each line has. Lines with few returns share the first's offset, those that
/// see little of the wire the first's tilt.
struct LineColumns {
  struct Columns {
    int offset = -1, tilt = -1;
    double share = 0.0;  // of the returns
  };
  std::map<std::uint16_t, Columns> of;
  int count = 0;
  std::vector<double> offset_share, tilt_share;  // by column; 0 where it is of the other sort

  explicit LineColumns(const std::vector<OnWire>& returns) {
    struct Seen {
      size_t returns = 0;
      double low = 1e300, high = -1e300;
    };
    std::map<std::uint16_t, Seen> seen;
    for (const OnWire& r : returns) {
      Seen& s = seen[r.line];
      ++s.returns;
      s.low = std::min(s.low, r.s), s.high = std::max(s.high, r.s);
    }
    bool first = true, first_long = true;
    for (const auto& [line, s] : seen) {
      Columns& c = of[line];
      c.share = static_cast<double>(s.returns) / static_cast<double>(returns.size());
      if (s.returns < fewest_of_line) continue;
      if (!first) c.offset = add(c.share, 0.0);
      first = false;
      if (s.high - s.low < shortest_tilted) continue;
      if (!first_long) c.tilt = add(0.0, c.share);
      first_long = false;
    }
  }
  /// Indicators less their means: level and slope stay the means of all lines.
  void fill(const OnWire& r, double u, Eigen::VectorXd& row) const {
    for (int k = 0; k < count; ++k) row(3 + k) = -offset_share[static_cast<size_t>(k)] - u * tilt_share[static_cast<size_t>(k)];
    const Columns& c = of.at(r.line);
    if (c.offset >= 0) row(3 + c.offset) += 1.0;
    if (c.tilt >= 0) row(3 + c.tilt) += u;
  }
  /// How each line's curve differs from the mean, by the columns' unknowns.
  std::vector<LineOfFlight> differences(const Eigen::VectorXd& unknown) const {
    double level = 0.0, tilt = 0.0;
    for (int k = 0; k < count; ++k)
      level += offset_share[static_cast<size_t>(k)] * unknown(k), tilt += tilt_share[static_cast<size_t>(k)] * unknown(k);
    std::vector<LineOfFlight> out;
    for (const auto& [line, c] : of)
      out.push_back({line, c.share, (c.offset < 0 ? 0.0 : unknown(c.offset)) - level, (c.tilt < 0 ? 0.0 : unknown(c.tilt)) - tilt});
    return out;
  }

 private:
  int add(double offset, double tilt) {
    offset_share.push_back(offset), tilt_share.push_back(tilt);
    return count++;
  }
};

class Fit {
 public:
  explicit Fit(const std::vector<OnWire>& returns)
      : returns_(returns), lines_(returns), differences_(Eigen::VectorXd::Zero(lines_.count)) {}

  CatenaryFit run() {
    CatenaryFit out;
    if (returns_.size() < 5 || !start(out.curve)) return out;
    std::vector<char> used(returns_.size(), 1);
    for (int round = 0; round < rounds; ++round) {
      if (!step(out.curve, used)) return out;
      const std::vector<char> before = used;
      reject(out.curve, used);
      if (round > 2 && used == before && last_step_ < 1e-9) break;
    }
    finish(out, used);
    return out;
  }

 private:
  bool start(Catenary& c) const {
    double low = returns_[0].s, high = low, sum = 0.0;
    for (const OnWire& r : returns_) {
      low = std::min(low, r.s);
      high = std::max(high, r.s);
      sum += r.s;
    }
    if (high - low < 1.0) return false;
    c.at = sum / static_cast<double>(returns_.size());
    // The parabola through them.
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const OnWire& r : returns_) {
      const double u = r.s - c.at;
      const Eigen::Vector3d row(1.0, u, 0.5 * u * u);
      normal += row * row.transpose();
      right += row * r.z;
    }
    const Eigen::Vector3d p = normal.ldlt().solve(right);
    if (!p.allFinite()) return false;
    c.level = p(0), c.slope = p(1), c.kappa = p(2) / std::sqrt(1.0 + p(1) * p(1));
    return true;
  }

  Eigen::VectorXd row_of(const Catenary& c, const OnWire& r) const {
    Eigen::VectorXd row(3 + lines_.count);
    row.head<3>() = c.gradient(r.s);
    lines_.fill(r, r.s - c.at, row);
    return row;
  }
  double residual(const Catenary& c, const OnWire& r) const {
    if (lines_.count == 0) return r.z - c.z(r.s);
    const Eigen::VectorXd row = row_of(c, r);
    return r.z - c.z(r.s) - row.tail(lines_.count).dot(differences_);
  }

  bool step(Catenary& c, const std::vector<char>& used) {
    const int n = 3 + lines_.count;
    normal_ = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (size_t k = 0; k < returns_.size(); ++k) {
      if (!used[k]) continue;
      const Eigen::VectorXd row = row_of(c, returns_[k]);
      normal_ += row * row.transpose();
      right += row * residual(c, returns_[k]);
    }
    const Eigen::VectorXd change = normal_.ldlt().solve(right);
    if (!change.allFinite()) return false;
    c.level += change(0), c.slope += change(1), c.kappa += change(2);
    differences_ += change.tail(lines_.count);
    last_step_ = std::abs(change(0));
    return std::abs(c.slope) < 3.0 && std::abs(c.kappa) < 1.0;
  }

  void reject(const Catenary& c, std::vector<char>& used) const {
    std::vector<double> sizes;
    for (const OnWire& r : returns_) sizes.push_back(std::abs(residual(c, r)));
    const double limit = rejected_beyond * std::max(finest_sigma, core::mad_to_sigma * core::median(sizes));
    for (size_t k = 0; k < sizes.size(); ++k) used[k] = sizes[k] <= limit;
  }

  void finish(CatenaryFit& out, const std::vector<char>& used) const {
    double squares = 0.0;
    for (size_t k = 0; k < returns_.size(); ++k) {
      if (!used[k]) continue;
      ++out.used;
      squares += std::pow(residual(out.curve, returns_[k]), 2);
    }
    const double redundancy = static_cast<double>(out.used) - static_cast<double>(normal_.rows());
    if (redundancy < 1.0) return;
    out.sigma = std::max(finest_sigma, std::sqrt(squares / redundancy));
    const Eigen::MatrixXd all = normal_.ldlt().solve(Eigen::MatrixXd::Identity(normal_.rows(), normal_.cols()));
    out.covariance = out.sigma * out.sigma * all.topLeftCorner<3, 3>();
    out.lines = lines_.differences(differences_);
    out.sigma_lines = sigma_of_mean();
    out.found = out.covariance.allFinite();
  }
  /// The mean of the lines' heights is as good as they agree.
  double sigma_of_mean() const {
    std::vector<double> level;
    bool first = true;
    for (const LineOfFlight& l : lines_.differences(differences_)) {
      const bool own = lines_.of.at(l.line).offset >= 0;
      if (own || first) level.push_back(l.level);
      first = first && own;
    }
    if (level.size() < 2) return 0.0;
    const auto n = static_cast<double>(level.size());
    double mean = 0.0, squares = 0.0;
    for (const double v : level) mean += v / n;
    for (const double v : level) squares += (v - mean) * (v - mean);
    return std::sqrt(squares / (n * (n - 1.0)));
  }

  const std::vector<OnWire>& returns_;
  LineColumns lines_;
  Eigen::VectorXd differences_;
  Eigen::MatrixXd normal_;
  double last_step_ = 0.0;
};

}  // namespace

double Catenary::z(double s) const {
  const double u = s - at, x = kappa * u, c = std::sqrt(1.0 + slope * slope);
  if (std::abs(x) < series_below) return level + u * (slope + x * (c / 2 + x * (slope / 6 + x * c / 24)));
  return level + (slope * std::sinh(x) + c * (std::cosh(x) - 1.0)) / kappa;
}

double Catenary::dz(double s) const {
  const double x = kappa * (s - at);
  return slope * std::cosh(x) + std::sqrt(1.0 + slope * slope) * std::sinh(x);
}

Eigen::Vector3d Catenary::gradient(double s) const {
  const double u = s - at, x = kappa * u, c = std::sqrt(1.0 + slope * slope);
  // d(slope sinh x + c (cosh x - 1))/d slope / kappa
  const double by_slope = std::abs(x) < series_below ? u * (1.0 + x * (slope / c / 2 + x * (1.0 / 6 + x * slope / c / 24)))
                                                     : (std::sinh(x) + slope / c * (std::cosh(x) - 1.0)) / kappa;
  const double by_kappa = std::abs(x) < series_below ? u * u * (c / 2 + x * (slope / 3 + x * c / 8)) : (u * dz(s) - (z(s) - level)) / kappa;
  return {1.0, by_slope, by_kappa};
}

double Catenary::s0() const { return at - std::asinh(slope) / kappa; }
double Catenary::z0() const { return level + (1.0 - std::sqrt(1.0 + slope * slope)) / kappa; }
double Catenary::place_of(double chord_slope) const { return at + (std::asinh(chord_slope) - std::asinh(slope)) / kappa; }

double CatenaryFit::sigma_z(double s) const {
  const Eigen::Vector3d g = curve.gradient(s);
  return std::sqrt(std::max(0.0, g.dot(covariance * g)));
}

CatenaryFit fit_catenary(const std::vector<OnWire>& returns) { return Fit(returns).run(); }

}  // namespace swath::terrain
