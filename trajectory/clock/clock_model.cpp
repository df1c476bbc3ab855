// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: Reis, Camargo, Tommaselli (2011) for the literal correction and the convergence; Galleani, Tavella (2010), "Time and the Kalman
// filter", for the clock as integrated random walk; Huber (1981) for the weights. Deviations: the paper corrects by straight lines between
// the log's records and flags 1000 s; here that is the model `literal` with convergence `fixed`.
#include "trajectory/clock/clock_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/statistics.h"

namespace swath::trajectory {
namespace {

constexpr size_t side = 6;               // records on either side of a step that its size is taken from
constexpr double step_limit = 12.0;      // times the scatter: a step of less is left to the walk
constexpr double smallest_step = 1e-6;   // s
constexpr size_t wide = 25, narrow = 9;  // records of a running median: for steps and spikes, for the time to settle
constexpr int sustained = 10;            // calm records that make a settled clock
constexpr double calmest = 1e-7;         // s, scatter below which logs are not distinguished

/// Records behind which the clock steps, with the step's size. A step is a jump between two neighbours that the level keeps afterwards:
/// an outlier of the log comes back, a steered clock runs over several records.
std::vector<std::pair<size_t, double>> find_steps(const core::ClockData& log, const std::vector<double>& scatter) {
  const size_t n = log.size();
  std::vector<std::pair<size_t, double>> found;
  for (size_t i = 2; i + 3 < n; ++i) {
    const double dt = log.time[i + 1] - log.time[i], middle = log.time[i] + 0.5 * dt;
    const clock::Line before = clock::line_through(log.time, log.offset, i >= side ? i - side + 1 : 0, i, middle);
    const clock::Line after = clock::line_through(log.time, log.offset, i + 1, std::min(n - 1, i + side), middle);
    const double step = after.level - before.level;
    const double jump = log.offset[i + 1] - log.offset[i] - 0.5 * (before.slope + after.slope) * dt;
    // Slopes that change, or are carried over a gap, may look like a step.
    const double slopes = 3.0 * std::abs(after.slope - before.slope) + 1.5 * (before.spread + after.spread);
    if (std::abs(step) < smallest_step + step_limit * scatter[i] + slopes * dt) continue;
    if (std::abs(jump - step) > 0.3 * std::abs(step)) continue;
    if (!found.empty() && i - found.back().first < side) {
      if (std::abs(step) > std::abs(found.back().second)) found.back() = {i, step};
    } else {
      found.emplace_back(i, step);
    }
  }
  return found;
}

/// First instant of the stretch from which the scatter stays calm.
double settled_from(const core::ClockData& log, const ClockStretch& s, const std::vector<double>& scatter, double calm_scatter,
                    double calm_jitter, double factor) {
  int calm = 0;
  for (size_t i = s.first; i <= s.last; ++i) {
    const bool quiet = scatter[i] <= factor * calm_scatter && (log.jitter.empty() || log.jitter[i] <= factor * calm_jitter);
    calm = quiet ? calm + 1 : 0;
    if (calm == sustained || (quiet && i == s.last && static_cast<size_t>(calm) == s.last - s.first + 1))
      return log.time[i + 1 - static_cast<size_t>(calm)];
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

ClockModel::ClockModel(core::ClockData log, const ClockOptions& options) : log_(std::move(log)), options_(options) {
  const size_t n = log_.size();
  if (n < 2) throw core::Error("the clock's log has " + core::counted(n, "record"), "clock", "two are needed at least");
  for (size_t i = 1; i < n; ++i)
    if (!(log_.time[i] > log_.time[i - 1]))
      throw core::Error("the times of the clock's log do not rise", "clock: record " + std::to_string(i));

  const std::vector<double> rough = clock::scatter_of(log_, 0, n - 1, wide);
  ClockStretch stretch;
  for (const auto& [record, step] : find_steps(log_, rough)) {
    stretch.last = record;
    stretches_.push_back(stretch);
    stretch.first = record + 1;
    stretch.step = step;
  }
  stretch.last = n - 1;
  stretches_.push_back(stretch);

  std::vector<double> scatter(n);
  for (const ClockStretch& s : stretches_) {
    const std::vector<double> own = clock::scatter_of(log_, s.first, s.last, narrow);
    std::copy(own.begin(), own.end(), scatter.begin() + static_cast<std::ptrdiff_t>(s.first));
  }
  const double calm_scatter = std::max(calmest, core::quantile(scatter, 0.25, 0.0));
  const double calm_jitter = log_.jitter.empty() ? 0.0 : std::max(calmest, core::quantile(log_.jitter, 0.25, 0.0));
  for (ClockStretch& s : stretches_) {
    s.settled = log_.time[s.first];
    if (options_.convergence == Convergence::fixed) s.settled += options_.convergence_time.value;
    if (options_.convergence == Convergence::detect)
      s.settled = settled_from(log_, s, scatter, calm_scatter, calm_jitter, options_.settled_factor);
  }
  if (options_.model == ClockMethod::literal) return;
  noise_.resize(n);
  walk_.resize(n);
  filtered_.resize(n);
  smoothed_.resize(n);
  for (const ClockStretch& s : stretches_) smooth(s);
}

void ClockModel::smooth(const ClockStretch& s) {
  const size_t n = s.last - s.first + 1;
  clock::Records r;
  r.time = {log_.time.data() + s.first, n};
  r.offset = {log_.offset.data() + s.first, n};
  r.shape = log_.jitter.empty() ? std::vector<double>(n, 1.0) : clock::running_median({log_.jitter.data() + s.first, n}, 5);
  for (double& j : r.shape) j = std::max(j, calmest);
  r.steered = log_.steered;
  r.spike = clock::spikes_of(r.time, r.offset, clock::scatter_of(log_, s.first, s.last, wide));
  const clock::Strengths strengths = clock::strengths_of(r);
  clock::Pass pass = clock::smoothed(r, strengths, outliers_);
  for (size_t i = 0; i < n; ++i) {
    noise_[s.first + i] = strengths.noise[i];
    walk_[s.first + i] = strengths.walk[i];
    filtered_[s.first + i] = pass.filtered[i];
    smoothed_[s.first + i] = pass.smoothed[i];
  }
}

ClockReading ClockModel::read_literal(double t) const {
  const auto after = std::upper_bound(log_.time.begin(), log_.time.end(), t);
  const size_t k = std::min(log_.size() - 2, static_cast<size_t>(std::max<std::ptrdiff_t>(0, after - log_.time.begin() - 1)));
  const double dt = log_.time[k + 1] - log_.time[k], w = std::clamp((t - log_.time[k]) / dt, 0.0, 1.0);
  ClockReading out;
  out.drift = (log_.offset[k + 1] - log_.offset[k]) / dt;
  out.offset = log_.offset[k] + w * (log_.offset[k + 1] - log_.offset[k]);
  return out;
}

ClockReading ClockModel::read_smooth(const ClockStretch& s, double t) const {
  const auto begin = log_.time.begin();
  const auto after = std::upper_bound(begin + static_cast<std::ptrdiff_t>(s.first), begin + static_cast<std::ptrdiff_t>(s.last) + 1, t);
  const auto next = static_cast<size_t>(after - begin);
  clock::State x;
  if (next == s.first) {
    x = clock::carried(smoothed_[s.first], t - log_.time[s.first], walk_[s.first]);
  } else if (next > s.last) {
    x = clock::carried(smoothed_[s.last], t - log_.time[s.last], walk_[s.last]);
  } else {
    // An instant between two records is a node without an observation: exact smoothing, no interpolation.
    const clock::Walk& walk = walk_[next - 1];
    const clock::State here = clock::carried(filtered_[next - 1], t - log_.time[next - 1], walk);
    x = clock::smoothed_back(here, smoothed_[next], log_.time[next] - t, walk);
  }
  return {x[0], x[1], std::sqrt(std::max(x[2], 0.0)), true, true};
}

ClockReading ClockModel::at(double t) const {
  size_t k = 0;  // the stretch that holds t, or the nearer one between two
  while (k + 1 < stretches_.size() && t > 0.5 * (log_.time[stretches_[k].last] + log_.time[stretches_[k + 1].first])) ++k;
  const ClockStretch& s = stretches_[k];
  ClockReading out = options_.model == ClockMethod::literal ? read_literal(t) : read_smooth(s, t);
  out.settled = t >= s.settled;
  out.inside = t >= log_.time[s.first] && t <= log_.time[s.last];
  if (out.inside) {
    const auto after = std::lower_bound(log_.time.begin(), log_.time.end(), t);
    if (after != log_.time.begin() && *after - *(after - 1) > options_.max_gap.value && *after != t) out.inside = false;
  } else if (options_.model == ClockMethod::robust && t > log_.time.front() && t < log_.time.back()) {
    // On either side of a step, and nobody knows when it was.
    const ClockStretch& later = t > log_.time[s.last] ? stretches_[k + 1] : s;
    out.sigma = std::hypot(out.sigma, later.step);
  }
  return out;
}

CorrectedEvents correct(core::EventTags events, const ClockModel& clock, const ClockOptions& options) {
  CorrectedEvents out;
  out.raw = events;
  const double shift = events.epoch - clock.log().epoch;
  for (size_t i = 0; i < events.size(); ++i) {
    const ClockReading r = out.readings.emplace_back(clock.at(shift + events.time[i]));
    events.time[i] += r.offset;
    events.sigma[i] = r.sigma > 0 ? std::hypot(r.sigma, options.tag_sigma.value) : 0.0;
    events.doubtful[i] = !r.settled || !r.inside;
    out.before_settled += !r.settled;
    out.outside_log += !r.inside;
  }
  events.computer_clock = false;
  out.events = std::move(events);
  return out;
}

}  // namespace swath::trajectory
