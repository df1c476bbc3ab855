// SPDX-License-Identifier: GPL-3.0-or-later
// The catenary of a wire of even weight (McLaughlin 2006, eq. 3) as
//   z(s) = level + (cosh(kappa u + t) - cosh t) / kappa,  u = s - at,  t = asinh(slope),
// fitted by Gauss-Newton with rejection of gross errors (Mikhail 1976). Deviation: below kappa u = 1e-3 the first terms of its series
// are taken (relative error below 1e-12).
#include "terrain/corridor/catenary.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/statistics.h"

namespace swath::terrain {
namespace {

constexpr double series_below = 1e-3;    // of kappa u
constexpr double rejected_beyond = 3.5;  // robust sigmas
constexpr double finest_sigma = 0.002;   // m: returns are not written finer
constexpr size_t fewest_of_line = 8;     // returns of a flight line with an offset of its own
constexpr int rounds = 12;

/// Offsets of flight lines: which column of the design each line has; lines with few returns share the first's.
struct LineColumns {
  std::map<std::uint16_t, int> column;
  int count = 0;
  std::vector<double> share;  // of the returns, by column

  explicit LineColumns(const std::vector<OnWire>& returns) {
    std::map<std::uint16_t, size_t> n;
    for (const OnWire& r : returns) ++n[r.line];
    bool first = true;
    for (const auto& [line, size] : n) {
      column[line] = -1;
      if (size < fewest_of_line) continue;
      if (!first) {
        column[line] = count++;
        share.push_back(static_cast<double>(size) / static_cast<double>(returns.size()));
      }
      first = false;
    }
  }
  /// Indicators less their means: the level stays the mean of all lines.
  void fill(const OnWire& r, Eigen::VectorXd& row) const {
    for (int k = 0; k < count; ++k) row(3 + k) = -share[static_cast<size_t>(k)];
    if (const int k = column.at(r.line); k >= 0) row(3 + k) += 1.0;
  }
};

class Fit {
 public:
  explicit Fit(const std::vector<OnWire>& returns) : returns_(returns), lines_(returns), offset_(Eigen::VectorXd::Zero(lines_.count)) {}

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
    lines_.fill(r, row);
    return row;
  }
  double residual(const Catenary& c, const OnWire& r) const {
    if (lines_.count == 0) return r.z - c.z(r.s);
    const Eigen::VectorXd row = row_of(c, r);
    return r.z - c.z(r.s) - row.tail(lines_.count).dot(offset_);
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
    offset_ += change.tail(lines_.count);
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
    if (lines_.count > 0) {  // the mean of the lines' heights is as good as they agree
      double scatter = std::pow(mean_offset(), 2);
      for (int k = 0; k < lines_.count; ++k) scatter += std::pow(offset_(k) - mean_offset(), 2);
      out.sigma_lines = std::sqrt(scatter / (lines_.count * (lines_.count + 1.0)));
    }
    out.found = out.covariance.allFinite();
  }
  double mean_offset() const { return offset_.sum() / (lines_.count + 1.0); }  // the first line's is 0

  const std::vector<OnWire>& returns_;
  LineColumns lines_;
  Eigen::VectorXd offset_;
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
