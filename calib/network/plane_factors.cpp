// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: returns of all lines lie on common planes, ranges and angles as observations (Skaloud and Lichti 2006; calib/adjust/tie_normals
// has the condition), on the states of a flight's adjustment (Brun, Cucci and Skaloud 2022; Pöppl et al. 2023). A pose between two instants
// is that of the mechanisation from the first of them, moved by the straight line between the corrections at both: what the IMU saw between
// them stays in the cloud. Deviations: the position's correction is linear, too (0.25 s and 1 mrad of attitude: 0.1 mm); the Brownian
// bridge of the attitude counts as independent from group to group.
#include "calib/network/plane_factors.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "calib/adjust/tie_system.h"
#include "calib/network/brownian_bridge.h"
#include "core/parallel.h"
#include "core/statistics.h"
#include "trajectory/ins/ins_smoother.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double least_range_sigma = 1e-3;  // m: a sigma of zero would leave nothing to weigh by
constexpr double least_noise_factor = 0.05;
constexpr size_t planes_at_a_time = 1024, planes_of_a_part = 16;
const Vector3d damping(1e-4, 1e-2, 1e-2);  // 1 / m^2, 1, 1: of a plane's step where its returns do not hold it; does not bias

CorrectionOptions without_corrections() {
  CorrectionOptions o;
  o.position = o.attitude = CorrectionForm::none;
  return o;
}

TieNoise noise_of(const core::SensorSigma& s) {
  return {std::max(least_range_sigma, s.range.value), s.scan_angle.value, s.beam_divergence.value / 4.0, s.time.value};
}

}  // namespace

struct PlaneFactors::Worker {
  ShotGeometry geometry;
  trajectory::Cursor cursor;
  std::vector<Condition> conditions{};
  std::vector<double> sorted{};
  MatrixXd rows{};
};

PlaneFactors::PlaneFactors(const TieSet& ties, const core::Scanner& scanner, const core::SensorSigma& sensor, std::vector<double> times,
                           std::vector<Parameter> unknown, const RobustOptions& robust, double surface, double wander, int threads)
    : ties_(&ties),
      scanner_(&scanner),
      stated_(noise_of(sensor)),
      noise_(stated_),
      times_(std::move(times)),
      unknown_(std::move(unknown)),
      robust_(robust.full, robust.zero),
      surface_(surface),
      wander_(wander),
      threads_(threads),
      no_knots_(ties.lines, 0.0, without_corrections(), {}),
      problem_{&ties, &scanner, nullptr, nullptr, unknown_, robust_, threads},
      blocks_(ties.groups.size()),
      turn_(ties.groups.size(), 0.0),
      weight_(ties.groups.size(), 1.0),
      rejected_(ties.groups.size(), 0),
      deviation_(ties.returns.size(), 0.0f) {
  state_.correction = VectorXd::Zero(0);
  state_.planes = ties.planes;
  state_.roughness.assign(ties.planes.size(), 0.0);
  size_t g = 0;
  for (std::uint32_t k = 0; k < ties.planes.size(); ++k) {
    first_group_.push_back(g);
    while (g < ties.groups.size() && ties.groups[g].plane == k) ++g;
  }
  first_group_.push_back(g);
}

int PlaneFactors::interval_at(double t) const {
  const auto next = std::upper_bound(times_.begin(), times_.end(), t) - times_.begin();
  return static_cast<int>(std::clamp<std::ptrdiff_t>(next - 1, 0, static_cast<std::ptrdiff_t>(times_.size()) - 2));
}

void PlaneFactors::fill_block(Worker& w, size_t number, double median) {
  const TieGroup& g = ties_->groups[number];
  GroupBlock& block = blocks_[number];
  int first = std::numeric_limits<int>::max(), last = -1;
  for (std::uint32_t i = g.begin; i < g.end; ++i) {
    if (!std::isfinite(w.conditions[i - g.begin].f)) continue;
    const int k = interval_at(w.geometry.time(ties_->returns.time[i]));
    first = std::min(first, k), last = std::max(last, k);
  }
  block.index.clear();
  for (int k = first; k <= last + 1; ++k)
    for (int c = 0; c < 6; ++c) block.index.push_back(number_of(k, c));
  const auto poses = static_cast<Eigen::Index>(block.index.size()), values = static_cast<Eigen::Index>(unknown_.size());
  for (int c = 0; c < static_cast<int>(unknown_.size()); ++c) block.index.push_back(calibration_number() + c);

  w.rows.setZero(poses + values + 4, g.end - g.begin);
  Vector3d turn = Vector3d::Zero();
  double weights = 0.0, sum_of_f = 0.0;
  BrownianBridge bridge;
  Eigen::Index used = 0;
  for (std::uint32_t i = g.begin; i < g.end; ++i) {
    const Condition& c = w.conditions[i - g.begin];
    if (!std::isfinite(c.f)) continue;
    const double sigma = scale_ * std::sqrt(c.variance());
    const double share = robust_((c.f - median) / sigma);
    if (share <= 0.0) {
      ++block.rejected;
      continue;
    }
    const double root = std::sqrt(share) / sigma, t = w.geometry.time(ties_->returns.time[i]);
    const int k = interval_at(t);
    const double s = std::clamp((t - times_[k]) / (times_[k + 1] - times_[k]), 0.0, 1.0);
    w.cursor.seek(t);
    const trajectory::Pose pose = w.cursor.pose(t);
    const auto local = trajectory::local_by_ecef({t, pose.position, pose.velocity, pose.ecef_R_body});
    const Vector3d by_position = (c.by.segment<3>(position_north) * local.block<3, 3>(0, 0)).transpose();
    const Vector3d by_turn = (c.by.segment<3>(attitude_roll) * local.block<3, 3>(6, 6)).transpose();
    auto row = w.rows.col(used++);
    const Eigen::Index at = 6 * (k - first);
    row.segment<3>(at) = (root * (1 - s)) * by_position;
    row.segment<3>(at + 3) = (root * (1 - s)) * by_turn;
    row.segment<3>(at + 6) = (root * s) * by_position;
    row.segment<3>(at + 9) = (root * s) * by_turn;
    for (Eigen::Index v = 0; v < values; ++v) row[poses + v] = root * c.by[unknown_[static_cast<size_t>(v)]];
    row.tail<4>() << -root, -root * c.u, -root * c.v, root * c.f;
    bridge.add(k, times_[k + 1] - times_[k], s, root * root);
    turn += root * root * by_turn;
    weights += root * root;
    sum_of_f += root * root * c.f;
    block.noise += c.range + c.angle;
    block.time += t;
    block.angle += w.geometry.angle(ties_->returns.angle[i]);
    block.range += w.geometry.range(ties_->returns.range[i]);
  }
  const Eigen::Index n = poses + values + 3;
  MatrixXd sum = MatrixXd::Zero(n + 1, n + 1);
  sum.selfadjointView<Eigen::Lower>().rankUpdate(w.rows.leftCols(used));
  sum.triangularView<Eigen::StrictlyUpper>() = sum.transpose();
  block.N = sum.topLeftCorner(n, n);
  block.b = sum.col(n).head(n);
  block.c = sum(n, n);
  block.used = static_cast<std::uint32_t>(used);
  if (used == 0) return;
  for (double* v : {&block.noise, &block.time, &block.angle, &block.range}) *v /= static_cast<double>(used);
  turn_[number] = (turn / weights).squaredNorm() * bridge.sum / (weights * weights);
  if (used >= 3) add_moments(robust_, w.conditions, deviation_.data() + g.begin, scale_, sum_of_f / weights, block);
}

void PlaneFactors::linearise_group(Worker& w, size_t number) {
  const TieGroup& g = ties_->groups[number];
  blocks_[number] = GroupBlock();
  turn_[number] = 0.0;
  w.conditions.resize(g.end - g.begin);
  w.sorted.clear();
  for (std::uint32_t i = g.begin; i < g.end; ++i) {
    Condition& c = w.conditions[i - g.begin];
    if (condition_of(problem_, w.geometry, state_, noise_, w.cursor, g, i, c)) {
      w.sorted.push_back(c.f);
    } else {
      c.f = std::numeric_limits<double>::quiet_NaN();
      ++blocks_[number].outside;
    }
  }
  if (w.sorted.empty()) return;
  const double median = core::median(w.sorted);
  for (std::uint32_t i = g.begin; i < g.end; ++i) {
    const Condition& c = w.conditions[i - g.begin];
    deviation_[i] = static_cast<float>((c.f - median) / std::sqrt(c.variance()));  // NaN where the trajectory does not reach
  }
  fill_block(w, number, median);
}

std::vector<char> PlaneFactors::intervals(const core::Calibration& calibration, double margin) const {
  std::vector<char> out(times_.size() - 1, 0);
  const ShotGeometry geometry(*scanner_, calibration);
  for (const TieGroup& g : ties_->groups) {
    const int last = interval_at(geometry.time(ties_->returns.time[g.end - 1]) + margin);
    for (int k = interval_at(geometry.time(ties_->returns.time[g.begin]) - margin); k <= last; ++k) out[static_cast<size_t>(k)] = 1;
  }
  return out;
}

void PlaneFactors::linearise(const trajectory::Trajectory& trajectory, const core::Calibration& calibration) {
  problem_.trajectory = &trajectory;
  problem_.knots = &no_knots_;  // of this copy
  state_.calibration = calibration;
  const size_t groups = ties_->groups.size();
  const auto work = [&](size_t first, size_t last) {
    Worker worker{ShotGeometry(*scanner_, calibration), trajectory::Cursor(trajectory)};
    for (size_t g = first; g < last; ++g) linearise_group(worker, g);
  };
  // Each group's block depends on nothing but the group: the answer is the same for any number of threads.
  const size_t threads = std::min<size_t>(static_cast<size_t>(std::max(1, threads_)), std::max<size_t>(1, groups / 16));
  std::vector<std::thread> others;
  for (size_t k = 1; k < threads; ++k) others.emplace_back(work, groups * k / threads, groups * (k + 1) / threads);
  work(0, groups / threads);
  for (std::thread& t : others) t.join();

  std::vector<double> sizes;
  for (const float z : deviation_)
    if (std::isfinite(z)) sizes.push_back(std::abs(static_cast<double>(z)));
  scale_ = std::max(least_noise_factor, core::mad_to_sigma * core::median(std::move(sizes), 1.0));
  set_noise();
}

// Ranges and angles apart: they weigh differently at nadir and at the swath's edge, and so do heights and attitude.
void PlaneFactors::set_noise() {
  update_white(blocks_, {std::vector<char>(blocks_.size(), 1), {}}, ComponentOptions(), factors_);
  noise_.range = stated_.range * factors_.range.factor;
  noise_.angle = stated_.angle * factors_.angle.factor;
  noise_.pointing = stated_.pointing * factors_.angle.factor;
}

void PlaneFactors::fit_plane(std::uint32_t k) {
  Matrix3d N = damping.asDiagonal();
  Vector3d b = Vector3d::Zero();
  for (size_t g = first_group_[k]; g < first_group_[k + 1]; ++g) {
    if (blocks_[g].used == 0 || left_out(g)) continue;
    N += blocks_[g].N.bottomRightCorner<3, 3>();
    b += blocks_[g].b.tail<3>();
  }
  move_plane(state_.planes[k], -N.ldlt().solve(b));
}

// As in the strip adjustment: what is typical of all planes is the records' noise, what goes beyond is the plane's.
void PlaneFactors::set_roughness() {
  const size_t planes = state_.planes.size();
  std::vector<double> noise(planes, 0.0), ratios;
  for (std::uint32_t k = 0; k < planes; ++k) {
    double sum = 0, n = 0;
    for (size_t g = first_group_[k]; g < first_group_[k + 1]; ++g) sum += blocks_[g].used * blocks_[g].noise, n += blocks_[g].used;
    noise[k] = n > 0 ? sum / n : 0.0;
    if (noise[k] > 0 && state_.planes[k].roughness > 0) ratios.push_back(std::pow(state_.planes[k].roughness, 2) / noise[k]);
  }
  const double typical = core::median(std::move(ratios), 1.0);
  for (size_t k = 0; k < planes; ++k)
    state_.roughness[k] = std::sqrt(std::max(0.0, std::pow(state_.planes[k].roughness, 2) - typical * noise[k]));
}

void PlaneFactors::fit(const trajectory::Trajectory& trajectory, const core::Calibration& calibration) {
  // Twice: the second time the normals are right and the planes' own slopes do not mix with their weights.
  for (int i = 0; i < 2; ++i) {
    linearise(trajectory, calibration);
    for (std::uint32_t k = 0; k < state_.planes.size(); ++k) fit_plane(k);
  }
  set_roughness();
}

double PlaneFactors::variance_between(size_t g) const { return surface_ * surface_ + wander_ * turn_[g]; }

PlaneFactors::Reduced PlaneFactors::reduced(std::uint32_t plane) const {
  Reduced out;
  Rest& rest = out.rest;
  for (size_t g = first_group_[plane]; g < first_group_[plane + 1]; ++g)
    if (weight(g) > 0.0 && blocks_[g].used > 0) rest.index.insert(rest.index.end(), blocks_[g].index.begin(), blocks_[g].index.end());
  std::sort(rest.index.begin(), rest.index.end());
  rest.index.erase(std::unique(rest.index.begin(), rest.index.end()), rest.index.end());
  const auto m = static_cast<Eigen::Index>(rest.index.size());
  MatrixXd N = MatrixXd::Zero(m + 3, m + 3);
  VectorXd b = VectorXd::Zero(m + 3);
  for (size_t g = first_group_[plane]; g < first_group_[plane + 1]; ++g) {
    if (weight(g) <= 0.0 || blocks_[g].used == 0) continue;
    GroupBlock block = blocks_[g];
    with_surface(block, std::sqrt(variance_between(g)));
    std::vector<Eigen::Index> at;
    for (const int i : block.index) at.push_back(std::lower_bound(rest.index.begin(), rest.index.end(), i) - rest.index.begin());
    for (Eigen::Index i = 0; i < 3; ++i) at.push_back(m + i);
    N(at, at) += weight(g) * block.N;
    b(at) += weight(g) * block.b;
    out.squares += weight(g) * block.c;
  }
  for (const ControlRow& row : control_rows({state_.planes[plane]}, 1.0)) {
    const double w = 1.0 / (row.sigma * row.sigma);
    N.bottomRightCorner<3, 3>() += w * row.by * row.by.transpose();
    b.tail<3>() += w * row.f * row.by;
    out.squares += w * row.f * row.f;
  }
  N.bottomRightCorner<3, 3>().diagonal() += damping;
  rest.inverse = Matrix3d(N.bottomRightCorner<3, 3>()).inverse();
  rest.N_xp = N.topRightCorner(m, 3);
  rest.b = b.tail<3>();
  const MatrixXd gain = rest.N_xp * rest.inverse;
  out.N = N.topLeftCorner(m, m) - gain * rest.N_xp.transpose();
  out.b = b.head(m) - gain * rest.b;
  return out;
}

PlaneFactors::Place PlaneFactors::place_of(int number, const FlightStates& states) const {
  if (number >= calibration_number()) return {states.common(), states.calibration_first() + number - calibration_number()};
  return {states.pose(number / 6), number % 6};
}

void PlaneFactors::scatter(const Rest& rest, const MatrixXd& N, const VectorXd& b, const FlightStates& states, NetworkNormals& into) const {
  std::vector<Place> places;
  std::vector<size_t> begin;  // of each node among them
  for (const int i : rest.index) {
    const Place p = place_of(i, states);
    if (places.empty() || places.back().node != p.node) begin.push_back(places.size());
    places.push_back(p);
  }
  begin.push_back(places.size());
  MatrixXd part;
  for (size_t a = 0; a + 1 < begin.size(); ++a)
    for (size_t c = 0; c <= a; ++c) {
      const int row_node = places[begin[a]].node, column_node = places[begin[c]].node;
      part.setZero(into.N.size(row_node), into.N.size(column_node));
      for (size_t i = begin[a]; i < begin[a + 1]; ++i)
        for (size_t j = begin[c]; j < begin[c + 1]; ++j)
          part(places[i].row, places[j].row) = N(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      into.N.add(row_node, column_node, part);
    }
  for (size_t i = 0; i < places.size(); ++i) into.b[into.N.first(places[i].node) + places[i].row] -= b[static_cast<Eigen::Index>(i)];
}

void PlaneFactors::add(const FlightStates& states, NetworkNormals& into) {
  rests_.clear();
  const size_t planes = state_.planes.size();
  rests_.resize(planes);
  std::vector<Reduced> some;
  for (size_t begin = 0; begin < planes; begin += planes_at_a_time) {
    some.assign(std::min(planes - begin, planes_at_a_time), {});
    core::in_parallel(some.size(), planes_of_a_part, [&](size_t first, size_t last) {
      for (size_t k = first; k < last; ++k) some[k] = reduced(static_cast<std::uint32_t>(begin + k));
    });
    for (size_t k = 0; k < some.size(); ++k) {
      into.squares += some[k].squares;
      scatter(some[k].rest, some[k].N, some[k].b, states, into);
      rests_[begin + k] = std::move(some[k].rest);
    }
  }
}

void PlaneFactors::follow(const VectorXd& x, const FlightStates& states) {
  for (std::uint32_t k = 0; k < rests_.size(); ++k) {
    const Rest& rest = rests_[k];
    VectorXd own(static_cast<Eigen::Index>(rest.index.size()));
    for (size_t i = 0; i < rest.index.size(); ++i) {
      const Place p = place_of(rest.index[i], states);
      own[static_cast<Eigen::Index>(i)] = x[states.first(p.node) + p.row];
    }
    move_plane(state_.planes[k], -rest.inverse * (rest.b + rest.N_xp.transpose() * own));
  }
}

std::vector<PlaneMisfit> PlaneFactors::misfits() const {
  std::vector<PlaneMisfit> out;
  for (size_t g = 0; g < blocks_.size(); ++g) {
    const GroupBlock& block = blocks_[g];
    PlaneMisfit m{ties_->groups[g].plane,
                  ties_->groups[g].line,
                  0.0,
                  0.0,
                  weight_[g],
                  block.used,
                  block.rejected,
                  block.time,
                  block.angle,
                  block.range,
                  0.0};
    if (block.used > 0) {
      m.rms = std::sqrt(block.c / block.weight());
      m.mean = -block.b[static_cast<Eigen::Index>(block.index.size())] / block.weight();
      m.sigma = std::sqrt(1.0 / block.weight() + variance_between(g));
    }
    out.push_back(m);
  }
  return out;
}

void PlaneFactors::weigh() {
  const std::vector<PlaneMisfit> all = misfits();
  std::vector<double> sizes;
  for (const PlaneMisfit& m : all)
    if (m.returns > 0) sizes.push_back(std::abs(m.mean) / m.sigma);
  const double scale = std::max(1.0, core::mad_to_sigma * core::median(std::move(sizes), 1.0));
  for (size_t g = 0; g < all.size(); ++g)
    if (all[g].returns > 0) weight_[g] = rejected_[g] ? 0.0 : robust_(all[g].mean / all[g].sigma / scale);
}

std::uint64_t PlaneFactors::left_out() const {
  return static_cast<std::uint64_t>(std::count_if(weight_.begin(), weight_.end(), [](double w) { return w <= 0.0; }));
}

std::uint64_t PlaneFactors::rejected() const { return static_cast<std::uint64_t>(std::count(rejected_.begin(), rejected_.end(), char{1})); }

}  // namespace swath::calib
