// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/record_times.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/config/units.h"
#include "core/error.h"
#include "core/statistics.h"
#include "core/time.h"

namespace swath::io {
namespace {

constexpr double missing = 1.5;            // steps from one record to the next where one is missing
constexpr double regular = 0.01;           // of a step: less jitter than this is left alone
constexpr double least_strict_gap = 0.02;  // of a step
constexpr double tolerated_rate = 0.1;     // between a stated step and that of the file
constexpr size_t neighbours = 50;          // either side, of the smoothing line
constexpr size_t catch_up = 10;            // records within which a late stamp is made up for
constexpr double year_2000 = 630720013.0;  // GPS time of 2000-01-01T00:00:00Z
constexpr double rolled_over = 1024 * core::seconds_per_week;

std::vector<double> differences(const std::vector<double>& t) {
  std::vector<double> d(t.size() > 1 ? t.size() - 1 : 0);
  for (size_t k = 0; k < d.size(); ++k) d[k] = t[k + 1] - t[k];
  return d;
}

/// A difference that is long only because record k-1 was stamped early or k late: soon after as many records have come as should have.
bool made_up(const std::vector<double>& t, size_t k, double step) {
  for (size_t j = 1; j <= catch_up && k + j < t.size(); ++j)
    if (t[k + j] - t[k - 1] < (static_cast<double>(j) + missing) * step) return true;
  return false;
}

std::vector<size_t> gaps_of(const std::vector<double>& t, double step, double longest, bool may_be_late) {
  std::vector<size_t> out;
  for (size_t k = 1; k < t.size(); ++k)
    if (t[k] - t[k - 1] > longest && !(may_be_late && made_up(t, k, step))) out.push_back(k);
  return out;
}

/// Replaces t[first, last) by lines through the neighbours of each; adds the squares of what it moved them by.
void smooth(std::vector<double>& t, size_t first, size_t last, double step, double& squares, double& largest) {
  const size_t n = last - first;
  if (n < 3) return;
  std::vector<double> off(n);  // from an even advance: small numbers
  for (size_t i = 0; i < n; ++i) off[i] = t[first + i] - t[first] - static_cast<double>(i) * step;
  const double start = t[first];
  for (size_t i = 0; i < n; ++i) {
    const size_t a = i > neighbours ? i - neighbours : 0, b = std::min(n - 1, i + neighbours);
    double mean = 0, slope = 0, square = 0;
    const double middle = 0.5 * static_cast<double>(a + b);
    for (size_t j = a; j <= b; ++j) {
      const double x = static_cast<double>(j) - middle;
      mean += off[j];
      slope += x * off[j];
      square += x * x;
    }
    mean /= static_cast<double>(b - a + 1);
    const double even = mean + slope / square * (static_cast<double>(i) - middle);
    const double moved = std::abs(off[i] - even);
    squares += moved * moved;
    largest = std::max(largest, moved);
    t[first + i] = start + static_cast<double>(i) * step + even;
  }
}

}  // namespace

Cadence settle_times(std::vector<double>& t, const CadenceRule& rule, const std::string& name) {
  Cadence out;
  const std::vector<double> d = differences(t);
  if (d.empty() && !rule.step) throw core::Error("one record alone has no step", name, "state the rate of the records");
  const double middle = d.empty() ? *rule.step : core::median(d);
  std::vector<double> deviation;
  for (const double v : d) deviation.push_back(std::abs(v - middle));
  const double common =
      d.empty() ? 0.0 : std::clamp(2 * core::quantile(deviation, 0.99), least_strict_gap * middle, (missing - 1) * middle);
  double sum = 0, squares = 0;
  deviation.clear();
  for (const double v : d)
    if (std::abs(v - middle) <= common) {
      sum += v;
      deviation.push_back(v);
    }
  const double found = deviation.empty() ? middle : sum / static_cast<double>(deviation.size());
  out.step = rule.step.value_or(found);
  if (std::abs(found - out.step) > tolerated_rate * out.step)
    throw core::usage_error(
        "the records come every " + core::format_number(found, 6) + " s, the stated rate makes " + core::format_number(out.step, 6) + " s",
        name, "state the rate of the file, or leave it out");
  for (double& v : deviation) {
    v = std::abs(v - out.step);
    squares += v * v;
  }
  // Differences of white jitter have twice its variance.
  out.jitter = deviation.empty() ? 0.0 : std::sqrt(0.5 * squares / static_cast<double>(deviation.size()));
  out.smoothed = rule.smooth && out.jitter > regular * out.step;
  double longest = missing * out.step;
  if (rule.strict && !deviation.empty())
    longest = out.step * (1 + std::clamp(2 * core::quantile(deviation, 0.99) / out.step, least_strict_gap, missing - 1));
  out.restarts = gaps_of(t, out.step, longest, out.smoothed);
  if (!out.smoothed) {
    out.largest_jitter = deviation.empty() ? 0.0 : *std::max_element(deviation.begin(), deviation.end());
    return out;
  }
  std::vector<double> even = t;
  squares = 0;
  for (size_t g = 0; g <= out.restarts.size(); ++g)
    smooth(even, g == 0 ? 0 : out.restarts[g - 1], g < out.restarts.size() ? out.restarts[g] : t.size(), out.step, squares,
           out.largest_jitter);
  const std::vector<double> steps = differences(even);
  if (std::any_of(steps.begin(), steps.end(), [](double v) { return v <= 0; })) {
    out.smoothed = false;  // jitter of many steps: no order to find
    out.restarts = gaps_of(t, out.step, longest, false);
    return out;
  }
  t = std::move(even);
  out.jitter = std::sqrt(squares / static_cast<double>(t.size()));
  return out;
}

void count_gaps(const std::vector<double>& from, const std::vector<double>& to, const std::string& what, core::Tally& tally) {
  std::vector<size_t> order(from.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return to[a] - from[a] > to[b] - from[b]; });
  for (const size_t i : order)
    tally.count(what, core::format_number(std::round((to[i] - from[i]) * 1e4) / 1e4) + " s from " + core::utc_text(from[i]));
}

void note_date(double first, const std::string& name, core::Tally& tally) {
  if (first < year_2000)
    tally.count("files dated before 2000: a GPS week number that rolled over at 1024?",
                name + ": " + core::utc_text(first) + ", 1024 weeks later is " + core::utc_text(first + rolled_over));
}

}  // namespace swath::io
