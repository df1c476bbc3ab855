// SPDX-License-Identifier: GPL-3.0-or-later
// No published source: Gauss-Markov with prior sigmas for each pass (position and attitude), weights after Huber from the residuals that
// the freest model leaves. Deviation: the error of a pass is the same within a stretch of it and changes from one to the next by as much as
// a smoothed trajectory's does in the time of the pass; what varies within a stretch is taken for scatter, and its cells count as few.
#include "calib/geometry/small_errors.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/statistics.h"

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double ground_varies = 0.02;  // m: the ground itself, from pass to pass
constexpr size_t most_of_pair = 400;    // cells of a pair of passes that are looked at
constexpr double count_of_pair = 120;   // and what they count as: their errors are not independent
constexpr int rounds = 6;
constexpr double full_weight = 2.5;  // sigmas
constexpr double mad_to_sigma = 1.4826;
constexpr int common = 6, of_pass = 6;  // unknowns: position and attitude of all passes, and of each
// No trajectory is better over minutes, whatever it states: m, rad.
constexpr double least_position = 0.04, least_attitude = 0.005 * core::degree, least_heading = 0.01 * core::degree;
constexpr double common_position = 0.05;   // m: of a base station, of a datum
constexpr double least_drift = 1e-4;       // share of a pass's variance
constexpr double correlated = 100.0;       // s over which errors of a smoothed trajectory stay alike
constexpr double between_stretches = 2.0;  // s

struct Row {
  double apart = 0.0, variance = 0.0, share = 1.0, weight = 1.0;
  size_t a = 0, b = 0;  // numbers of grounds; the same: control
  CellSensitivity of_a, of_b;
  size_t at_a = 0, at_b = 0;  // numbers of stretches
};

/// Least sigma of each value: what thermal and mechanical changes make of it in any case.
SmallVector least_sigmas() {
  SmallVector s;
  s << 0.003 * core::degree, 0.003 * core::degree, 0.006 * core::degree, 0.01, 0.01, 0.01, 0.01, 5e-6, 0.001 * core::degree, 5e-5, 1e-4;
  return s;
}

/// As good as unknown.
SmallVector free_sigmas() {
  SmallVector s;
  s << 0.2, 0.2, 0.2, 30, 30, 30, 300, 0.3, 0.2, 0.3, 3;
  return s;
}

/// The stretches of all grounds, by the times of their cells.
class Stretches {
 public:
  explicit Stretches(const SmallErrorsInput& in) {
    std::map<size_t, const core::Shots*> shots;
    for (const PassSample& s : in.sample.surfaces) shots[s.pass] = &s.shots;
    for (const PassGround& g : in.ground) {
      std::vector<double> times;
      for (const GroundCell& c : g.smooth) times.push_back(shots[g.pass]->time[c.sample]);
      std::sort(times.begin(), times.end());
      first_.push_back(drift_.size());
      std::vector<double>& starts = starts_.emplace_back();
      const double drift = times.empty() ? 0.0 : 1.0 - std::exp((times.front() - times.back()) / correlated);
      for (size_t i = 0; i < times.size(); ++i)
        if (i == 0 || times[i] - times[i - 1] > between_stretches)
          starts.push_back(times[i]), drift_.push_back(drift), ground_.push_back(first_.size() - 1);
    }
  }
  size_t size() const { return drift_.size(); }
  /// Number of the stretch of a ground's cell at a time.
  size_t at(size_t ground, double time) const {
    const std::vector<double>& starts = starts_[ground];
    return first_[ground] + static_cast<size_t>(std::upper_bound(starts.begin(), starts.end(), time) - starts.begin()) - 1;
  }
  size_t ground(size_t stretch) const { return ground_[stretch]; }
  /// Variance from stretch to stretch, in units of the pass's own.
  double drift(size_t stretch) const { return drift_[stretch]; }

 private:
  std::vector<std::vector<double>> starts_;
  std::vector<size_t> first_, ground_;
  std::vector<double> drift_;
};

std::vector<Row> rows_of(const SmallErrorsInput& in, const Stretches& stretches) {
  trajectory::Cursor cursor(in.trajectory);
  std::map<size_t, const core::Shots*> shots;
  for (const PassSample& s : in.sample.surfaces) shots[s.pass] = &s.shots;
  const auto look = [&](size_t ground, const GroundCell& cell, const Vector3d& direction) {
    return look_at(cell, *shots[in.ground[ground].pass], direction, in.geometry, cursor, in.frame);
  };
  const auto stretch = [&](size_t ground, const GroundCell& cell) {
    return stretches.at(ground, shots[in.ground[ground].pass]->time[cell.sample]);
  };
  std::vector<Row> out;
  for (const PairCells& p : in.pairs) {
    const size_t step = p.shared.size() / most_of_pair + 1, first = out.size();
    for (size_t k = 0; k < p.shared.size(); k += step) {
      const SharedCell& s = p.shared[k];
      const Vector3d normal = normal_of(s);
      const auto a = look(p.a, *s.a, normal), b = look(p.b, *s.b, normal);
      if (!a || !b) continue;
      const double variance = a->own + b->own + 2 * ground_varies * ground_varies;
      out.push_back({s.apart, variance, 1, 1, p.a, p.b, *a, *b, stretch(p.a, *s.a), stretch(p.b, *s.b)});
    }
    for (size_t k = first; k < out.size(); ++k) out[k].share = std::min(1.0, count_of_pair / static_cast<double>(out.size() - first));
  }
  for (const ControlCell& c : in.control)
    if (const auto a = look(c.ground, *c.cell, height_direction(*c.cell))) {
      const size_t at = stretch(c.ground, *c.cell);
      out.push_back({c.apart, a->own + ground_varies * ground_varies + c.sigma * c.sigma, 1, 1, c.ground, c.ground, *a, {}, at, at});
    }
  return out;
}

/// The unknowns: calibration, position of all passes, then each pass, then each stretch of them.
struct System {
  MatrixXd N;
  VectorXd r;
  double squares = 0.0;
};

struct Unknowns {
  size_t grounds;
  const Stretches& stretches;
  int of_ground(size_t g) const { return small_count + common + of_pass * static_cast<int>(g); }
  int of_stretch(size_t s) const { return of_ground(grounds + s); }
  int count() const { return of_stretch(stretches.size()); }
};

void fill(const Row& row, const Unknowns& at, VectorXd& d) {
  d.setZero();
  const bool control = row.a == row.b;
  d.head<small_count>() = row.of_a.by.head<small_count>();
  d.segment<common>(small_count) = row.of_a.by.segment<common>(position_north);
  for (const int first : {at.of_ground(row.a), at.of_stretch(row.at_a)})
    d.segment<of_pass>(first) = row.of_a.by.segment<of_pass>(position_north);
  if (control) return;
  d.head<small_count>() -= row.of_b.by.head<small_count>();
  d.segment<common>(small_count) -= row.of_b.by.segment<common>(position_north);
  for (const int first : {at.of_ground(row.b), at.of_stretch(row.at_b)})
    d.segment<of_pass>(first) -= row.of_b.by.segment<of_pass>(position_north);
}

/// What is known of the passes before.
void add_prior(const std::vector<Row>& rows, const Unknowns& at, System& s) {
  std::map<size_t, trajectory::PoseSigma> sigma;
  for (const Row& row : rows) sigma[row.a] = row.of_a.sigma, sigma[row.b] = row.a == row.b ? row.of_a.sigma : row.of_b.sigma;
  const auto weight = [](double stated, double least) { return 1 / (stated * stated + least * least); };
  trajectory::PoseSigma largest;
  for (const auto& [g, p] : sigma) {
    largest.north = std::max(largest.north, p.north), largest.east = std::max(largest.east, p.east);
    largest.down = std::max(largest.down, p.down), largest.roll = std::max(largest.roll, p.roll);
    largest.pitch = std::max(largest.pitch, p.pitch), largest.heading = std::max(largest.heading, p.heading);
  }
  // What alignment and base station leave is the same for all passes.
  const double all[common] = {weight(largest.north, common_position), weight(largest.east, common_position),
                              weight(largest.down, common_position),  weight(largest.roll, least_attitude),
                              weight(largest.pitch, least_attitude),  weight(largest.heading, least_heading)};
  for (int i = 0; i < common; ++i) s.N(small_count + i, small_count + i) += all[i];
  const auto add = [&](int first, const trajectory::PoseSigma& p, double by) {
    const double w[of_pass] = {weight(p.north, least_position), weight(p.east, least_position),  weight(p.down, least_position),
                               weight(p.roll, least_attitude),  weight(p.pitch, least_attitude), weight(p.heading, least_heading)};
    for (int i = 0; i < of_pass; ++i) s.N(first + i, first + i) += by * w[i];
  };
  for (size_t g = 0; g < at.grounds; ++g) add(at.of_ground(g), sigma[g], 1.0);
  for (size_t k = 0; k < at.stretches.size(); ++k)
    add(at.of_stretch(k), sigma[at.stretches.ground(k)], 1.0 / std::max(least_drift, at.stretches.drift(k)));
}

System system_of(const std::vector<Row>& rows, const Unknowns& at) {
  System s;
  const int n = at.count();
  s.N = MatrixXd::Zero(n, n);
  s.r = VectorXd::Zero(n);
  VectorXd d(n);
  std::vector<int> set;
  for (const Row& row : rows) {
    fill(row, at, d);
    set.clear();
    for (int i = 0; i < small_count + common; ++i) set.push_back(i);
    const auto with = [&](int first) {
      for (int i = 0; i < of_pass; ++i) set.push_back(first + i);
    };
    with(at.of_ground(row.a)), with(at.of_stretch(row.at_a));
    if (row.a != row.b) with(at.of_ground(row.b)), with(at.of_stretch(row.at_b));
    const double w = row.share * row.weight / row.variance;
    for (const int i : set) {
      s.r[i] += w * d[i] * row.apart;
      for (const int j : set) s.N(i, j) += w * d[i] * d[j];
    }
    s.squares += w * row.apart * row.apart;
  }
  add_prior(rows, at, s);
  return s;
}

/// Weights by the residuals of the freest model; their scatter becomes that of the rows.
void weigh(std::vector<Row>& rows, const Unknowns& at) {
  VectorXd d(at.count());
  for (int round = 0; round < rounds; ++round) {
    System s = system_of(rows, at);
    const SmallVector sigma = free_sigmas();
    for (int i = 0; i < small_count; ++i) s.N(i, i) += 1 / (sigma[i] * sigma[i]);
    const VectorXd x = s.N.ldlt().solve(s.r);
    std::vector<double> residual, size;
    for (const Row& row : rows) {
      fill(row, at, d);
      residual.push_back((row.apart - d.dot(x)) / std::sqrt(row.variance));
      size.push_back(std::abs(residual.back()));
    }
    const double scale = std::max(mad_to_sigma * core::median(std::move(size), 0.0), round + 1 == rounds ? 1.0 : 1e-3);
    for (size_t k = 0; k < rows.size(); ++k) {
      const double off = std::abs(residual[k]) / scale;
      rows[k].weight = off <= full_weight ? 1.0 : full_weight / off;
      if (round + 1 == rounds) rows[k].variance *= scale * scale;
    }
  }
}

}  // namespace

SmallErrors::Solution SmallErrors::with(const SmallVector& known, const std::vector<Parameter>& free) const {
  SmallMatrix C = prior;
  const SmallVector wide = free_sigmas();
  for (const Parameter p : free) {
    C.row(p).setZero(), C.col(p).setZero();
    C(p, p) = wide[p] * wide[p];
  }
  const SmallMatrix weight = C.ldlt().solve(SmallMatrix::Identity());
  const SmallMatrix inverse = (normal + weight).ldlt().solve(SmallMatrix::Identity());
  const SmallVector all = right + weight * known;
  Solution out;
  out.error = inverse * all;
  for (int i = 0; i < small_count; ++i) out.sigma[i] = std::sqrt(std::max(0.0, inverse(i, i)));
  out.squares = squares + known.dot(weight * known) - all.dot(out.error);
  return out;
}

SmallErrors small_errors(const SmallErrorsInput& in) {
  SmallErrors out;
  const SmallVector least = least_sigmas();
  out.prior = calibration_covariance(in.sensor);
  out.prior.diagonal() += least.cwiseProduct(least);
  const Stretches stretches(in);
  const Unknowns at{in.ground.size(), stretches};
  std::vector<Row> rows = rows_of(in, stretches);
  out.differences = rows.size();
  if (rows.empty()) return out;
  weigh(rows, at);
  const System s = system_of(rows, at);
  const auto n = s.N.rows() - small_count;
  const Eigen::LDLT<MatrixXd> passes(s.N.bottomRightCorner(n, n));
  const MatrixXd B = s.N.bottomLeftCorner(n, small_count);
  const VectorXd r = s.r.tail(n), solved = passes.solve(r);
  out.normal = s.N.topLeftCorner<small_count, small_count>() - B.transpose() * passes.solve(B);
  out.right = s.r.head<small_count>() - B.transpose() * solved;
  out.squares = s.squares - r.dot(solved);
  return out;
}

}  // namespace swath::calib
