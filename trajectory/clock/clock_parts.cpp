// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: Rauch, Tung, Striebel (1965); likelihood of innovations: Schweppe (1965); weights: Huber (1981), beyond eight sigma falling
// faster so that a wild record has no pull at all.
#include "trajectory/clock/clock_parts.h"

#include <algorithm>
#include <cmath>

#include "core/statistics.h"

namespace swath::trajectory::clock {
namespace {

constexpr size_t least_block = 40, most_blocks = 400;           // records; blocks of a log
constexpr size_t beside = 5;                                    // records on one side of a suspected spike, and at the start
constexpr double spike_limit = 8.0;                             // times the scatter
constexpr double huber_sigma = 3.0, wild = 8.0, outlier = 6.0;  // sigma
constexpr double huber_variance = 0.9973;                       // about E[z psi(z)] of a normal z at 3
constexpr int weight_rounds = 5;
// ntpd takes back 1/16 of an offset until the next one (CLOCK_PLL of its clock discipline), errors of the record included: the offset of a
// steered clock walks by that much at least.
constexpr double answer = 1.0 / 16.0;

// Grids of log10 of walk / noise for a median step dt and noise r: drift walk dt^3 / r^2, offset walk dt / r^2. Below the lowest a window
// cannot distinguish the walk from none (memory of the drift's: 1e-7^(-1/4) = 56 records); above the highest records are followed to the
// digit.
constexpr double drift_low = -7.0, drift_step = 0.75, offset_low = -4.5, offset_step = 0.75;
constexpr size_t drift_states = 13, offset_states = 9, states = drift_states * offset_states;
constexpr double spread = 0.5, jump_share = 0.05;  // from window to window: decades; share of blocks that are not alike at all

double clock_weight(double z) {
  const double a = std::abs(z);
  if (a <= huber_sigma) return 1.0;
  return huber_sigma / a * (a > wild ? (wild / a) * (wild / a) : 1.0);
}

/// Twice the negative logarithm of the density: a parabola, straight lines, logarithms.
double cost_of(double z) {
  const double a = std::abs(z);
  if (a <= huber_sigma) return z * z;
  if (a <= wild) return huber_sigma * (2 * a - huber_sigma);
  return huber_sigma * (2 * wild * (1 + std::log(a / wild)) - huber_sigma);
}

/// The state at the first record, from the line through the first ones, with ten times their uncertainty.
State start_of(const Records& r, size_t first, size_t last, double noise) {
  const size_t stop = std::min(last, first + 2 * beside);
  const Line line = line_through(r.time.subspan(first), r.offset.subspan(first), 0, stop - first, r.time[first]);
  const double drift = 10 * std::max(noise, 1e-12) / (r.time[first + 1] - r.time[first]) + 10 * line.spread;
  const double offset = 10 * noise + std::abs(r.offset[first] - line.level) * (r.spike[first] ? 0 : 1);
  return {line.level, line.slope, offset * offset, 0.0, drift * drift};
}

/// Adds an observation of the offset whose innovation has the variance s.
void update(State& x, double innovation, double s) {
  const double kx = x[2] / s, ky = x[3] / s;
  x[0] += kx * innovation;
  x[1] += ky * innovation;
  x[4] -= ky * x[3];
  x[3] -= kx * x[3];
  x[2] -= kx * x[2];
}

/// Cost of the innovations of records [first, last], the state `x` being that at the first one; `z_psi` gets the mean of z psi(z), `x` the
/// state at the last. The first `passed` observations are not judged.
double likelihood(const Records& r, size_t first, size_t last, size_t passed, double factor, const Walk& walk, State& x, double& z_psi) {
  double cost = 0, sum = 0;
  size_t seen = 0;
  for (size_t i = first; i <= last; ++i) {
    if (i > first) x = carried(x, r.time[i] - r.time[i - 1], walk);
    if (r.spike[i]) continue;
    const double noise = factor * factor * r.shape[i] * r.shape[i], s = x[2] + noise, e = r.offset[i] - x[0];
    const double z = e / std::sqrt(s), weight = clock_weight(z);
    if (seen++ >= passed) {
      cost += std::log(s) + cost_of(z);
      sum += weight * z * z;
    }
    update(x, e, x[2] + noise / weight);
  }
  z_psi = seen > passed ? sum / static_cast<double>(seen - passed) : huber_variance;
  return cost;
}

using Column = std::array<double, states>;

/// Some records in a row at each state of the grid.
struct Block {
  double middle = 0.0;                                   // time
  double log_scale_offset = 0.0, log_scale_drift = 0.0;  // of walk in units of factor^2
  Column cost, log_factor;
};

double exponent(size_t state, bool drift) {
  return drift ? drift_low + drift_step * static_cast<double>(state / offset_states)
               : offset_low + offset_step * static_cast<double>(state % offset_states);
}

/// `x`: the clock before the block (at its first record) for each state of the grid, becomes that at its last record.
Block fit_block(const Records& r, size_t first, size_t last, std::array<State, states>& x, std::array<Walk, states>& walks) {
  std::vector<double> steps, shapes, bends;
  for (size_t i = first; i < last; ++i) steps.push_back(r.time[i + 1] - r.time[i]);
  for (size_t i = first; i <= last; ++i) shapes.push_back(r.shape[i]);
  for (size_t i = first + 1; i < last; ++i)
    bends.push_back(std::abs(r.offset[i + 1] - 2 * r.offset[i] + r.offset[i - 1]) / (std::sqrt(6.0) * r.shape[i]));
  const double step = median(steps), shape = median(shapes);
  const double start = std::max(core::mad_to_sigma * median(bends), 1e-9 / shape);
  Block out;
  out.middle = 0.5 * (r.time[first] + r.time[last]);
  out.log_scale_offset = std::log(shape * shape / step);
  out.log_scale_drift = out.log_scale_offset - 2 * std::log(step);
  for (size_t k = 0; k < states; ++k) {
    const Walk unit{std::exp(out.log_scale_offset) * std::pow(10.0, exponent(k, false)),
                    std::exp(out.log_scale_drift) * std::pow(10.0, exponent(k, true))};
    double factor = start, z_psi = 1;
    for (int round = 0;; ++round) {
      State now = x[k];
      walks[k] = {unit.offset * factor * factor, unit.drift * factor * factor};
      out.cost[k] = likelihood(r, first, last, first == 0 ? 2 : 0, factor, walks[k], now, z_psi);
      if (round == 3) {
        x[k] = now;
        break;
      }
      factor *= std::sqrt(std::clamp(z_psi / huber_variance, 0.05, 20.0));
    }
    out.log_factor[k] = std::log(factor);
  }
  return out;
}

Column normalised(Column c) {
  double sum = 0;
  for (const double v : c) sum += v;
  for (double& v : c) v /= sum;
  return c;
}

/// Chances of going from state i to j between blocks: mostly alike, seldom anything.
std::vector<double> transitions() {
  std::vector<double> out(states * states);
  for (size_t i = 0; i < states; ++i) {
    double sum = 0;
    for (size_t j = 0; j < states; ++j) {
      const double a = (exponent(i, true) - exponent(j, true)) / spread, b = (exponent(i, false) - exponent(j, false)) / spread;
      sum += out[i * states + j] = std::exp(-0.5 * (a * a + b * b));
    }
    for (size_t j = 0; j < states; ++j)
      out[i * states + j] = (1 - jump_share) * out[i * states + j] / sum + jump_share / static_cast<double>(states);
  }
  return out;
}

/// The mixture of the states that may have led to j, by its moments.
State mixed(const std::array<State, states>& x, const Column& chance, const std::vector<double>& to, size_t j) {
  double sum = 0, offset = 0, drift = 0;
  for (size_t i = 0; i < states; ++i) {
    const double p = chance[i] * to[i * states + j];
    sum += p;
    offset += p * (x[i][0] - x[0][0]);  // differences: the offset may be long against its spread
    drift += p * x[i][1];
  }
  State out{x[0][0] + offset / sum, drift / sum, 0, 0, 0};
  for (size_t i = 0; i < states; ++i) {
    const double p = chance[i] * to[i * states + j] / sum, dx = x[i][0] - out[0], dy = x[i][1] - out[1];
    out[2] += p * (x[i][2] + dx * dx);
    out[3] += p * (x[i][3] + dx * dy);
    out[4] += p * (x[i][4] + dy * dy);
  }
  return out;
}

/// Blocks of the records and the posterior of each one's state, from the filters that interact at the blocks' borders.
std::vector<Column> posterior(const Records& r, std::vector<Block>& blocks) {
  const size_t n = r.size(), count = std::clamp<size_t>(n / least_block, 1, most_blocks);
  const std::vector<double> to = transitions();
  std::vector<Column> emission, forward;
  std::array<State, states> x;
  std::array<Walk, states> walks;
  for (size_t b = 0; b < count; ++b) {
    const size_t first = b * n / count, last = (b + 1) * n / count - 1;
    if (b == 0) {
      x.fill(start_of(r, 0, n - 1, *std::max_element(r.shape.begin(), r.shape.end())));
    } else {
      std::array<State, states> before = x;
      for (size_t i = 0; i < states; ++i) before[i] = carried(x[i], r.time[first] - r.time[first - 1], walks[i]);
      for (size_t j = 0; j < states; ++j) x[j] = mixed(before, forward.back(), to, j);
    }
    blocks.push_back(fit_block(r, first, last, x, walks));
    const Column& cost = blocks.back().cost;
    const double least = *std::min_element(cost.begin(), cost.end());
    Column here;
    for (size_t k = 0; k < states; ++k) here[k] = std::exp(-0.5 * (cost[k] - least));
    emission.push_back(here);
    if (b > 0)
      for (size_t j = 0; j < states; ++j) {
        double sum = 0;
        for (size_t i = 0; i < states; ++i) sum += forward.back()[i] * to[i * states + j];
        here[j] *= sum;
      }
    forward.push_back(normalised(here));
  }
  std::vector<Column> out(count);
  Column backward;
  backward.fill(1.0);
  for (size_t b = count; b-- > 0;) {
    Column both, before;
    for (size_t k = 0; k < states; ++k) both[k] = forward[b][k] * backward[k];
    out[b] = normalised(both);
    for (size_t i = 0; i < states; ++i) {
      before[i] = 0;
      for (size_t j = 0; j < states; ++j) before[i] += to[i * states + j] * emission[b][j] * backward[j];
    }
    backward = normalised(before);
  }
  return out;
}

/// Filter and smoother with given weights; in the first round (`find`) they are found from the innovations on the way.
Pass pass_over(const Records& r, const Strengths& s, std::vector<double>& weight, bool find) {
  const size_t n = r.time.size();
  Pass out;
  out.filtered.resize(n);
  for (size_t i = 0; i < n; ++i) {
    const double noise = s.noise[i] * s.noise[i];
    State& x = out.filtered[i];
    x = i == 0 ? start_of(r, 0, n - 1, s.noise[0]) : carried(out.filtered[i - 1], r.time[i] - r.time[i - 1], s.walk[i - 1]);
    if (r.spike[i]) continue;
    const double e = r.offset[i] - x[0];
    if (find) weight[i] = clock_weight(e / std::sqrt(x[2] + noise));
    update(x, e, x[2] + noise / weight[i]);
  }
  out.smoothed = out.filtered;
  for (size_t i = n - 1; i-- > 0;)
    out.smoothed[i] = smoothed_back(out.filtered[i], out.smoothed[i + 1], r.time[i + 1] - r.time[i], s.walk[i]);
  return out;
}

}  // namespace

double median(std::vector<double> v) { return core::quantile(std::move(v), 0.5, 0.0); }

std::vector<double> running_median(std::span<const double> v, size_t width) {
  std::vector<double> out;
  for (size_t i = 0; i < v.size(); ++i) {
    const size_t first = i >= width / 2 ? i - width / 2 : 0, last = std::min(v.size() - 1, i + width / 2);
    out.push_back(median({v.begin() + static_cast<std::ptrdiff_t>(first), v.begin() + static_cast<std::ptrdiff_t>(last) + 1}));
  }
  return out;
}

std::vector<double> scatter_of(const core::ClockData& log, size_t first, size_t last, size_t width) {
  const size_t n = last - first + 1;
  if (n < 3) return std::vector<double>(n, 0.0);
  std::vector<double> bend(n);
  for (size_t i = 1; i + 1 < n; ++i) {
    const size_t k = first + i;
    // Distance from the straight line between the neighbours; its sigma is sqrt(1 + w^2 + (1 - w)^2) times that of one record.
    const double w = (log.time[k] - log.time[k - 1]) / (log.time[k + 1] - log.time[k - 1]);
    bend[i] = core::mad_to_sigma * std::abs(log.offset[k] - (1 - w) * log.offset[k - 1] - w * log.offset[k + 1]) /
              std::sqrt(1 + w * w + (1 - w) * (1 - w));
  }
  bend.front() = bend[1];
  bend.back() = bend[n - 2];
  return running_median(bend, width);
}

Line line_through(std::span<const double> time, std::span<const double> offset, size_t first, size_t last, double t) {
  std::vector<double> slopes, levels;
  for (size_t i = first; i < last; ++i) slopes.push_back((offset[i + 1] - offset[i]) / (time[i + 1] - time[i]));
  Line out;
  out.slope = median(slopes);
  for (size_t i = first; i <= last; ++i) levels.push_back(offset[i] + out.slope * (t - time[i]));
  out.level = median(levels);
  for (double& v : slopes) v = std::abs(v - out.slope);
  out.spread = median(slopes);
  return out;
}

std::vector<std::uint8_t> spikes_of(std::span<const double> time, std::span<const double> offset, const std::vector<double>& scatter) {
  const size_t n = time.size();
  std::vector<std::uint8_t> out(n, 0);
  if (n < 2 * beside) return out;
  for (size_t i = 0; i < n; ++i) {
    const double t = time[i], limit = spike_limit * scatter[i];
    const bool has_before = i >= 3, has_after = i + 3 < n;
    const Line before = has_before ? line_through(time, offset, i >= beside ? i - beside : 0, i - 1, t) : Line{};
    const Line after = has_after ? line_through(time, offset, i + 1, std::min(n - 1, i + beside), t) : Line{};
    if (has_before && has_after) {
      const double middle = 0.5 * (before.level + after.level), off = std::abs(offset[i] - middle);
      out[i] = off > limit && std::abs(before.level - after.level) < 0.3 * off;
    } else {
      // At an end only one line is known, and it is carried on: twice the distance, and the slopes' own spread.
      const Line& line = has_before ? before : after;
      out[i] = std::abs(offset[i] - line.level) > 2 * limit + 3 * line.spread * std::abs(t - time[has_before ? i - beside : i + beside]);
    }
  }
  return out;
}

State carried(const State& x, double dt, const Walk& walk) {
  const double a = std::abs(dt);  // uncertainty grows either way
  return {x[0] + x[1] * dt, x[1], x[2] + 2 * dt * x[3] + dt * dt * x[4] + walk.offset * a + walk.drift * a * a * a / 3,
          x[3] + dt * x[4] + walk.drift * dt * a / 2, x[4] + walk.drift * a};
}

State smoothed_back(const State& here, const State& later, double dt, const Walk& walk) {
  const State p = carried(here, dt, walk);
  // G = P F^T (F P F^T + Q)^-1; rows of P F^T, and the inverse of the 2 x 2 matrix.
  const double a00 = here[2] + dt * here[3], a01 = here[3], a10 = here[3] + dt * here[4], a11 = here[4];
  const double det = p[2] * p[4] - p[3] * p[3];
  if (!(det > 0)) return here;
  const double g00 = (a00 * p[4] - a01 * p[3]) / det, g01 = (a01 * p[2] - a00 * p[3]) / det;
  const double g10 = (a10 * p[4] - a11 * p[3]) / det, g11 = (a11 * p[2] - a10 * p[3]) / det;
  const double dx = later[0] - p[0], dy = later[1] - p[1];
  const double dxx = later[2] - p[2], dxy = later[3] - p[3], dyy = later[4] - p[4];
  const double h00 = g00 * dxx + g01 * dxy, h01 = g00 * dxy + g01 * dyy;
  const double h10 = g10 * dxx + g11 * dxy, h11 = g10 * dxy + g11 * dyy;
  return {here[0] + g00 * dx + g01 * dy, here[1] + g10 * dx + g11 * dy, here[2] + h00 * g00 + h01 * g01, here[3] + h00 * g10 + h01 * g11,
          here[4] + h10 * g10 + h11 * g11};
}

Strengths strengths_of(const Records& r) {
  const size_t n = r.time.size();
  Strengths out;
  if (n < 4) {  // too short to judge: as noisy as the log says, the drift unknown
    for (size_t i = 0; i < n; ++i) out.noise.push_back(r.shape[i] == 1.0 ? 1e-3 : r.shape[i]);
    out.walk.assign(n, {});
    return out;
  }
  std::vector<Block> blocks;
  const std::vector<Column> chances = posterior(r, blocks);
  struct Logs {
    double factor = 0, offset = 0, drift = 0;
  };
  std::vector<Logs> logs;
  for (size_t w = 0; w < blocks.size(); ++w) {
    // Means of the walks' square roots: sigma hardly grows with a walk (power 1/8), but what may be missed of it counts too.
    Logs l;
    double root_offset = 0, root_drift = 0;
    for (size_t k = 0; k < states; ++k) {
      const double p = chances[w][k], f = blocks[w].log_factor[k];
      l.factor += p * f;
      root_offset += p * std::exp(f + 0.5 * std::log(10.0) * exponent(k, false));
      root_drift += p * std::exp(f + 0.5 * std::log(10.0) * exponent(k, true));
    }
    l.offset = 2 * std::log(root_offset) + blocks[w].log_scale_offset;
    l.drift = 2 * std::log(root_drift) + blocks[w].log_scale_drift;
    logs.push_back(l);
  }
  size_t k = 0;
  for (size_t i = 0; i < n; ++i) {
    while (k + 2 < blocks.size() && r.time[i] > blocks[k + 1].middle) ++k;
    const size_t k1 = std::min(k + 1, blocks.size() - 1);
    const double w = k1 == k ? 0.0 : std::clamp((r.time[i] - blocks[k].middle) / (blocks[k1].middle - blocks[k].middle), 0.0, 1.0);
    const auto mix = [&](double Logs::*m) { return std::exp((1 - w) * logs[k].*m + w * logs[k1].*m); };
    out.noise.push_back(mix(&Logs::factor) * r.shape[i]);
    out.walk.push_back({mix(&Logs::offset), mix(&Logs::drift)});
    if (r.steered && i + 1 < n) {
      const double least = answer * out.noise[i] * answer * out.noise[i] / (r.time[i + 1] - r.time[i]);
      out.walk[i].offset = std::max(out.walk[i].offset, least);
    }
  }
  return out;
}

Pass smoothed(const Records& r, const Strengths& s, size_t& outliers) {
  const size_t n = r.time.size();
  std::vector<double> weight(n, 1.0), z(n, 0.0);
  Pass out;
  for (int round = 0; round <= weight_rounds; ++round) {
    out = pass_over(r, s, weight, round == 0);
    if (round == weight_rounds) break;
    for (size_t i = 0; i < n; ++i) {
      // The residual's own variance: that of the record less that of the smoothed value, which has seen it.
      const double variance = s.noise[i] * s.noise[i];
      const double left = std::max(variance - out.smoothed[i][2] * weight[i], 0.05 * variance);
      z[i] = (r.offset[i] - out.smoothed[i][0]) / std::sqrt(left);
      weight[i] = clock_weight(z[i]);
    }
  }
  for (size_t i = 0; i < n; ++i) outliers += r.spike[i] || std::abs(z[i]) > outlier;
  return out;
}

}  // namespace swath::trajectory::clock
