// SPDX-License-Identifier: GPL-3.0-or-later
// No published source: Gauss-Markov with prior sigmas for each pass (position and attitude), weights after Huber from the residuals that
// the freest model leaves. Deviation: the error of a pass is constant along it; what varies is taken for scatter, and the cells of one
// place count as few.
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
constexpr double full_weight = 2.5;     // sigmas
constexpr int common = 6, of_pass = 6;  // unknowns: position and attitude of all passes, and of each
// No trajectory is better over minutes, whatever it states: m, rad.
constexpr double least_position = 0.04, least_attitude = 0.005 * core::degree, least_heading = 0.01 * core::degree;
constexpr double common_position = 0.05;  // m: of a base station, of a datum

struct Row {
  double apart = 0.0, variance = 0.0, share = 1.0, weight = 1.0;
  size_t a = 0, b = 0;  // numbers of grounds; the same: control
  CellSensitivity of_a, of_b;
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

std::vector<Row> rows_of(const SmallErrorsInput& in) {
  trajectory::Cursor cursor(in.trajectory);
  std::map<size_t, const core::Shots*> shots;
  for (const PassSample& s : in.sample.surfaces) shots[s.pass] = &s.shots;
  const auto look = [&](size_t ground, const GroundCell& cell, const Vector3d& direction) {
    return look_at(cell, *shots[in.ground[ground].pass], direction, in.geometry, cursor, in.frame);
  };
  std::vector<Row> out;
  for (const PairCells& p : in.pairs) {
    const size_t step = p.shared.size() / most_of_pair + 1, first = out.size();
    for (size_t k = 0; k < p.shared.size(); k += step) {
      const Vector3d normal = normal_of(p.shared[k]);
      const auto a = look(p.a, *p.shared[k].a, normal), b = look(p.b, *p.shared[k].b, normal);
      if (a && b) out.push_back({p.shared[k].apart, a->own + b->own + 2 * ground_varies * ground_varies, 1, 1, p.a, p.b, *a, *b});
    }
    for (size_t k = first; k < out.size(); ++k) out[k].share = std::min(1.0, count_of_pair / static_cast<double>(out.size() - first));
  }
  for (const ControlCell& c : in.control)
    if (const auto a = look(c.ground, *c.cell, height_direction(*c.cell)))
      out.push_back({c.apart, a->own + ground_varies * ground_varies + c.sigma * c.sigma, 1, 1, c.ground, c.ground, *a, {}});
  return out;
}

/// The unknowns: calibration, position of all passes, then each pass.
struct System {
  MatrixXd N;
  VectorXd r;
  double squares = 0.0;
};

int first_of(size_t ground) { return small_count + common + of_pass * static_cast<int>(ground); }

void fill(const Row& row, VectorXd& d) {
  d.setZero();
  const bool control = row.a == row.b;
  d.head<small_count>() = row.of_a.by.head<small_count>();
  d.segment<common>(small_count) = row.of_a.by.segment<common>(position_north);
  d.segment<of_pass>(first_of(row.a)) = row.of_a.by.segment<of_pass>(position_north);
  if (control) return;
  d.head<small_count>() -= row.of_b.by.head<small_count>();
  d.segment<common>(small_count) -= row.of_b.by.segment<common>(position_north);
  d.segment<of_pass>(first_of(row.b)) -= row.of_b.by.segment<of_pass>(position_north);
}

System system_of(const std::vector<Row>& rows, size_t grounds) {
  System s;
  const int n = first_of(grounds);
  s.N = MatrixXd::Zero(n, n);
  s.r = VectorXd::Zero(n);
  VectorXd d(n);
  std::vector<int> set;
  for (const Row& row : rows) {
    fill(row, d);
    set.clear();
    for (int i = 0; i < small_count + common; ++i) set.push_back(i);
    for (const size_t g : {row.a, row.b})
      for (int i = 0; i < of_pass; ++i) set.push_back(first_of(g) + i);
    if (row.a == row.b) set.resize(set.size() - of_pass);
    const double w = row.share * row.weight / row.variance;
    for (const int i : set) {
      s.r[i] += w * d[i] * row.apart;
      for (const int j : set) s.N(i, j) += w * d[i] * d[j];
    }
    s.squares += w * row.apart * row.apart;
  }
  // Prior of the passes.
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
  for (size_t g = 0; g < grounds; ++g) {
    const trajectory::PoseSigma& p = sigma[g];
    const double w[of_pass] = {weight(p.north, least_position), weight(p.east, least_position),  weight(p.down, least_position),
                               weight(p.roll, least_attitude),  weight(p.pitch, least_attitude), weight(p.heading, least_heading)};
    for (int i = 0; i < of_pass; ++i) s.N(first_of(g) + i, first_of(g) + i) += w[i];
  }
  return s;
}

/// Weights by the residuals of the freest model; their scatter becomes that of the rows.
void weigh(std::vector<Row>& rows, size_t grounds) {
  VectorXd d(first_of(grounds));
  for (int round = 0; round < rounds; ++round) {
    System s = system_of(rows, grounds);
    const SmallVector sigma = free_sigmas();
    for (int i = 0; i < small_count; ++i) s.N(i, i) += 1 / (sigma[i] * sigma[i]);
    const VectorXd x = s.N.ldlt().solve(s.r);
    std::vector<double> residual, size;
    for (const Row& row : rows) {
      fill(row, d);
      residual.push_back((row.apart - d.dot(x)) / std::sqrt(row.variance));
      size.push_back(std::abs(residual.back()));
    }
    const double scale = std::max(core::mad_to_sigma * core::median(std::move(size), 0.0), round + 1 == rounds ? 1.0 : 1e-3);
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
  std::vector<Row> rows = rows_of(in);
  out.differences = rows.size();
  if (rows.empty()) return out;
  weigh(rows, in.ground.size());
  const System s = system_of(rows, in.ground.size());
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
