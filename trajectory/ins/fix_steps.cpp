// SPDX-License-Identifier: GPL-3.0-or-later
// Generalised likelihood ratio (Willsky & Jones 1976): a step s of the fixes from fix k on changes the innovations by G s, with G from the
// filter's own gains, so that s and its chi-square follow by least squares from those of the next seconds. The same for an error of fix k
// alone; the step must be the more probable of the two. Deviations: hypotheses begin where one innovation is improbable, so that a step
// of less than four of its sigmas passes; the likelihood is scaled by the median NIS, so that a filter whose noise is stated too small does
// not see steps everywhere.
#include "trajectory/ins/fix_steps.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

/// A hypothesis whose window is over.
struct Judged {
  FixStep step;
  double alone = 0.0;  ///< chi-square of one wrong fix
};

/// The fix from which on the stated sigmas are others, if that is beside fix `k`: both change at once, and the test may find its neighbour.
size_t with_quality(const core::GnssData& gnss, size_t k) {
  constexpr size_t beside = 3;
  constexpr double much = 4.0;  // times in the variance
  for (size_t j = std::max<size_t>(1, k - std::min(k, beside)); j < std::min(gnss.size(), k + beside + 1); ++j) {
    const double ratio = gnss.covariance[j].trace() / gnss.covariance[j - 1].trace();
    if (ratio > much || ratio < 1.0 / much) return j;
  }
  return k;
}

Judged judged(const Problem& problem, const Hypothesis& h) {
  const Node& node = problem.nodes[h.node];
  const Matrix3d ned = ned_at(problem.gnss.position[static_cast<size_t>(node.fix)]);
  const Matrix3d covariance = ned.transpose() * h.step.N.inverse() * ned;
  FixStep step;
  const size_t first = with_quality(problem.gnss, static_cast<size_t>(node.fix));
  step.first = problem.gnss.time[first];
  step.time = 0.5 * (problem.gnss.time[first - 1] + step.first);
  step.size = ned.transpose() * h.step.value();
  step.sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  step.chi_square = h.step.chi_square();
  return {step, h.alone.chi_square()};
}

/// Those that are sure, the most probable one of each minute: what it leaves in the innovations after it may look like another. Squares of
/// innovations are `scale` times what they should be.
std::vector<FixStep> chosen(std::vector<Judged> all, double scale, double fixes) {
  const double sure = core::chi_square_limit(false_alarms / std::max(1.0, fixes), 3.0);
  std::stable_sort(all.begin(), all.end(), [](const Judged& a, const Judged& b) { return a.step.chi_square > b.step.chi_square; });
  std::vector<FixStep> out;
  for (Judged& j : all) {
    FixStep& step = j.step;
    if (step.chi_square < sure * scale || step.chi_square - j.alone < decisive * scale) continue;
    step.sigma *= std::sqrt(scale);
    step.chi_square /= scale;
    if (std::none_of(out.begin(), out.end(), [&](const FixStep& o) { return std::abs(o.first - step.first) < usual_interval; }))
      out.push_back(step);
  }
  return out;
}

/// Median of the stated variances, north east down, m^2.
Vector3d stated_between(const core::GnssData& gnss, double begin, double end) {
  std::array<std::vector<double>, 3> variances;
  for (size_t k = 0; k < gnss.size(); ++k) {
    if (gnss.time[k] <= begin || gnss.time[k] > end) continue;
    const Matrix3d ned = ned_at(gnss.position[k]);
    const Vector3d v = (ned.transpose() * gnss.covariance[k] * ned).diagonal();
    for (size_t i = 0; i < 3; ++i) variances[i].push_back(v[static_cast<Eigen::Index>(i)]);
  }
  Vector3d out;
  for (size_t i = 0; i < 3; ++i) out[static_cast<Eigen::Index>(i)] = std::max(core::median(std::move(variances[i]), 1.0), 1e-12);
  return out;
}

/// Levels between steps, beside the one that most of the time has. Levels within three sigmas of one another count as the same.
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
  const auto found = [&](size_t i) {
    const double begin = i > 0 ? steps[i - 1].time : -std::numeric_limits<double>::infinity();
    const double end = i < steps.size() ? steps[i].time : std::numeric_limits<double>::infinity();
    return FixLevel{alike(levels[i], *usual) ? Vector3d::Zero() : Vector3d(levels[i].at - usual->at),
                    stated_between(problem.gnss, begin, end)};
  };
  FixLevel before = found(0);
  for (size_t i = 0; i < steps.size(); ++i) steps[i].before = before, steps[i].after = before = found(i + 1);
}

}  // namespace

bool add_fix_steps(Problem& problem, InsFilter filter) {
  FixOutages outages(problem);
  constexpr size_t max_open = 64;
  std::vector<Hypothesis> open;
  std::vector<Judged> closed;
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
    const bool comparable = fix && outages.none_before(node, outcome);
    if (comparable && outcome.nis > improbable && open.size() < max_open)
      open.push_back({k, 0, Effect(problem.layout.size), Effect(problem.layout.size)});
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
    for (const Hypothesis& h : open)
      if (over(h) && h.step.chi_square() > improbable) closed.push_back(judged(problem, h));
    std::erase_if(open, over);
  }
  for (const Hypothesis& h : open)
    if (h.fixes >= 2) closed.push_back(judged(problem, h));
  const double expected = core::chi_square_limit(0.5, 3.0);
  const std::vector<FixStep> found =
      chosen(std::move(closed), std::max(1.0, core::median(nis, expected) / expected), static_cast<double>(nis.size()));
  std::vector<FixStep>& steps = problem.steps;
  const size_t known = steps.size();
  for (const FixStep& step : found)
    if (std::none_of(steps.begin(), steps.end(), [&](const FixStep& s) { return std::abs(s.first - step.first) < step_window; }))
      steps.push_back(step);
  if (steps.size() == known) return false;
  std::sort(steps.begin(), steps.end(), [](const FixStep& a, const FixStep& b) { return a.first < b.first; });
  const double lasts = problem.nodes.back().time - problem.nodes.front().time;
  const bool usual = steps.size() <= 2 || static_cast<double>(steps.size()) * usual_interval < lasts;  // a shift of one line is two
  if (!usual) steps.clear();
  set_levels(problem, steps);
  return usual;
}

}  // namespace swath::trajectory
