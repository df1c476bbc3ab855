// SPDX-License-Identifier: GPL-3.0-or-later
// Generalised likelihood ratio (Willsky & Jones 1976): a step s of the fixes from fix k on changes the innovations by G s, with G from the
// filter's own gains, so that s and its chi-square follow by least squares from those of the next seconds. The same for an error of fix k
// alone; the step must be the more probable of the two. Deviations: hypotheses begin where one innovation is improbable, so that a step
// of less than four of its sigmas passes; the likelihood is scaled by the median NIS, so that a filter whose noise is stated too small does
// not see steps everywhere.
#include "trajectory/ins/fix_steps.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/distributions.h"
#include "core/statistics.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double improbable = 16.3;      // NIS of three degrees of freedom: 1e-3
constexpr double false_alarms = 1e-3;    // probability of one in a flight
constexpr double decisive = 16.0;        // by which it must exceed that of one wrong fix
constexpr double step_window = 10.0;     // s
constexpr double usual_interval = 60.0;  // s from step to step: more often, something else is wrong, which the report's other tests name
constexpr int fewest_fixes = 6;          // that a window holds

/// What an error vector does to estimate and innovations.
struct Effect {
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, most_states, 3> of_estimate;
  Matrix3d N = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();

  explicit Effect(int states) { of_estimate.setZero(states, 3); }
  void pass(const StateMatrix& transition) { of_estimate = (transition * of_estimate).eval(); }
  /// `in_fix`: the update is of a position that has the error.
  void pass(const Update& u, double weight, bool in_fix) {
    Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 3, 3> G = -u.design * of_estimate;
    if (in_fix) G += Matrix3d::Identity();
    N.noalias() += G.transpose() * (u.weight / weight) * G;
    b.noalias() += G.transpose() * (u.weight / weight) * u.innovation;
    of_estimate += u.gain * G;
  }
  Vector3d value() const { return N.ldlt().solve(b); }
  double chi_square() const { return b.dot(value()); }
};

struct Hypothesis {
  size_t node;
  int fixes = 0;
  Effect step, alone;
};

/// After an outage the innovations show how far the IMU drifted, and nothing of the fixes.
class FixOutages {
 public:
  explicit FixOutages(const Problem& problem) : problem_(&problem), usual_(core::median_step(problem.gnss.time)) {}
  /// Fixes in their order.
  bool none_before(const Node& node, const FixOutcome& outcome) {
    constexpr double gap = 3.0;   // usual intervals
    constexpr double most = 4.0;  // variance of an innovation, in those of the fix
    const auto k = static_cast<size_t>(node.fix);
    if (k == 0 || node.time - problem_->gnss.time[k - 1] > gap * usual_) last_ = node.time;
    const double expected = outcome.innovation_sigma.squaredNorm() / problem_->gnss.covariance[k].trace();
    return node.time - last_ >= step_window && expected <= most * problem_->variance;
  }

 private:
  const Problem* problem_;
  double usual_, last_ = -1e300;
};

FixStep step_of(const Problem& problem, const Hypothesis& h) {
  const size_t fix = static_cast<size_t>(problem.nodes[h.node].fix);
  const Matrix3d ned = ned_at(problem.gnss.position[fix]);
  const Matrix3d covariance = ned.transpose() * h.step.N.inverse() * ned;
  FixStep out;
  out.fix = fix;
  out.first = problem.nodes[h.node].time;
  out.time = h.node > 0 ? 0.5 * (problem.nodes[h.node - 1].time + out.first) : out.first;
  out.size = ned.transpose() * h.step.value();
  out.sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  out.chi_square = h.step.chi_square();
  return out;
}

/// Those that are sure, the most probable one of each minute: what it leaves in the innovations after it may look like another.
std::vector<FixStep> chosen(const Problem& problem, std::vector<Hypothesis> all, double scale, double fixes) {
  const double sure = core::chi_square_limit(false_alarms / std::max(1.0, fixes), 3.0);
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.step.chi_square() > b.step.chi_square(); });
  std::vector<FixStep> out;
  for (const Hypothesis& h : all) {
    const double chi_square = h.step.chi_square();
    if (h.fixes < 2 || chi_square < sure * scale || chi_square - h.alone.chi_square() < decisive * scale) continue;
    const FixStep step = step_of(problem, h);
    if (std::none_of(out.begin(), out.end(), [&](const FixStep& o) { return std::abs(o.first - step.first) < usual_interval; }))
      out.push_back(step);
  }
  return out;
}

/// Levels between steps, beside the one that most of the time has. Levels within three sigmas of one another are one.
void set_levels(const Problem& problem, std::vector<FixStep>& steps) {
  if (steps.empty()) return;
  struct Level {
    Vector3d at = Vector3d::Zero(), variance = Vector3d::Zero();
    double lasts = 0.0;
  };
  std::vector<Level> levels(steps.size() + 1);
  for (size_t i = 0; i < levels.size(); ++i) {
    const double begin = i > 0 ? steps[i - 1].time : problem.nodes.front().time;
    levels[i].lasts = (i < steps.size() ? steps[i].time : problem.nodes.back().time) - begin;
    if (i == 0) continue;
    levels[i].at = levels[i - 1].at + steps[i - 1].size;
    levels[i].variance = levels[i - 1].variance + steps[i - 1].sigma.cwiseAbs2();
  }
  const auto alike = [](const Level& a, const Level& b) {
    constexpr double apart = 9.0;  // three sigmas, squared
    const Vector3d variance = (a.variance - b.variance).cwiseAbs().cwiseMax(1e-12);
    return &a == &b || (a.at - b.at).cwiseAbs2().cwiseQuotient(variance).maxCoeff() < apart;
  };
  const auto time_of = [&](const Level& level) {
    double sum = 0.0;
    for (const Level& other : levels) sum += alike(level, other) ? other.lasts : 0.0;
    return sum;
  };
  const Level* usual = &levels.front();
  for (const Level& level : levels)
    if (time_of(level) > time_of(*usual)) usual = &level;
  const auto beside = [&](const Level& level) -> Vector3d {
    return alike(level, *usual) ? Vector3d::Zero() : Vector3d(level.at - usual->at);
  };
  for (size_t i = 0; i < steps.size(); ++i) steps[i].before = beside(levels[i]), steps[i].after = beside(levels[i + 1]);
}

}  // namespace

bool add_fix_steps(Problem& problem, InsFilter filter) {
  FixOutages outages(problem);
  std::vector<Hypothesis> open, closed;
  std::vector<double> nis;
  NodeRecord record;
  for (size_t k = 0; k < problem.nodes.size(); ++k) {
    const Node& node = problem.nodes[k];
    const bool fix = node.fix >= 0;
    FixOutcome outcome;
    filter.predict(k, &record);
    filter.update(k, &record, &outcome);
    for (Hypothesis& h : open) h.step.pass(record.transition), h.alone.pass(record.transition);
    if (fix) nis.push_back(outcome.nis);
    const bool judged = fix && outages.none_before(node, outcome);
    if (judged && outcome.nis > improbable) open.push_back({k, 0, Effect(problem.layout.size), Effect(problem.layout.size)});
    for (Hypothesis& h : open) {
      h.fixes += fix;
      for (size_t u = 0; u < record.updates.size(); ++u) {
        const bool position = fix && u == 0;
        const double weight = position && h.node == k ? outcome.weight : 1.0;  // others that are down-weighted stay so
        h.step.pass(record.updates[u], weight, position);
        h.alone.pass(record.updates[u], weight, position && h.node == k);
      }
    }
    const auto over = [&](const Hypothesis& h) { return h.fixes >= fewest_fixes && node.time - problem.nodes[h.node].time >= step_window; };
    const auto done = std::stable_partition(open.begin(), open.end(), [&](const Hypothesis& h) { return !over(h); });
    std::move(done, open.end(), std::back_inserter(closed));
    open.erase(done, open.end());
  }
  std::move(open.begin(), open.end(), std::back_inserter(closed));
  const double expected = core::chi_square_limit(0.5, 3.0);
  const std::vector<FixStep> found =
      chosen(problem, std::move(closed), std::max(1.0, core::median(nis, expected) / expected), static_cast<double>(nis.size()));
  std::vector<FixStep>& steps = problem.steps;
  const size_t known = steps.size();
  for (const FixStep& step : found)
    if (std::none_of(steps.begin(), steps.end(), [&](const FixStep& s) { return std::abs(s.first - step.first) < step_window; }))
      steps.push_back(step);
  if (steps.size() == known) return false;
  std::sort(steps.begin(), steps.end(), [](const FixStep& a, const FixStep& b) { return a.first < b.first; });
  const bool usual = static_cast<double>(steps.size()) * usual_interval < problem.nodes.back().time - problem.nodes.front().time;
  if (!usual) steps.clear();
  set_levels(problem, steps);
  return usual;
}

}  // namespace swath::trajectory
