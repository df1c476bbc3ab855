// SPDX-License-Identifier: GPL-3.0-or-later
// A test of runs: with a chance p of repeating a value, n records hold a run of L repeats with a probability of n p^L at most. p is the
// largest of the records before the run, after it and of all, for digits count more where the body is steady. An axis that mostly repeats
// its value is not judged: there smooth motion makes runs.
#include "io/records/frozen_axes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>

#include "core/statistics.h"

namespace swath::io {
namespace {

constexpr size_t six = 6;
constexpr size_t shortest = 10;               // repeats
constexpr size_t beside = 1000;               // records on either side that show how the axis and the others behave
constexpr size_t fewest_beside = 100;         // of them on one side, to show it
constexpr double by_chance = 1e-6;            // probability of such a run in the whole record
constexpr double mostly = 0.5;                // share of repeats
constexpr double goes_on = 0.5;               // of another axis' noise beside the run
constexpr size_t fewest_standing = 6000;      // records, to call an axis one that stands: half a minute at 200 Hz
constexpr size_t many_values = 20;            // of an axis whose noise its digits resolve: then the other axes' do, too
constexpr size_t noise_records = 2 * beside;  // records within the run, for that noise

/// The six columns of a record.
class SixAxes {
 public:
  SixAxes(const std::vector<Eigen::Vector3d>& gyro, const std::vector<Eigen::Vector3d>& accelerometer)
      : gyro_(&gyro), accelerometer_(&accelerometer) {}
  size_t size() const { return gyro_->size(); }
  double at(size_t axis, size_t k) const {
    return axis < 3 ? (*gyro_)[k][static_cast<Eigen::Index>(axis)] : (*accelerometer_)[k][static_cast<Eigen::Index>(axis - 3)];
  }
  bool repeats(size_t axis, size_t k) const { return at(axis, k) == at(axis, k - 1); }

 private:
  const std::vector<Eigen::Vector3d>*gyro_, *accelerometer_;
};

/// Sizes of the second differences within [first, last): motion is smooth, noise is not.
void add_noise(const SixAxes& c, size_t axis, size_t first, size_t last, std::vector<double>& sizes) {
  for (size_t k = first; k + 2 < last; ++k) sizes.push_back(std::abs(c.at(axis, k) - 2.0 * c.at(axis, k + 1) + c.at(axis, k + 2)));
}

struct Sides {
  size_t begin, end;  ///< of the records on both sides, around the run
};

bool another_goes_on(const SixAxes& c, const FrozenAxis& run, const Sides& sides) {
  for (size_t axis = 0; axis < six; ++axis) {
    if (axis == run.axis) continue;
    std::vector<double> within, outside;
    add_noise(c, axis, run.first, std::min(run.last, run.first + noise_records), within);
    add_noise(c, axis, sides.begin, run.first, outside);
    add_noise(c, axis, run.last, sides.end, outside);
    const double usual = core::median(std::move(outside), 0.0);
    if (usual > 0.0 && core::median(std::move(within), 0.0) >= goes_on * usual) return true;
  }
  return false;
}

/// How often an axis repeats its value in [first, last), at most; nothing where that is too short.
std::optional<double> chance_of(const std::vector<std::uint32_t>& repeats, size_t first, size_t last) {
  if (last < first + fewest_beside) return std::nullopt;
  return (repeats[last] - repeats[first] + 1.0) / (static_cast<double>(last - first) + 2.0);
}

void find_in(const SixAxes& c, size_t axis, std::vector<FrozenAxis>& out) {
  const size_t n = c.size();
  std::vector<std::uint32_t> repeats(n + 1, 0);  // among the records before
  for (size_t k = 0; k < n; ++k) repeats[k + 1] = repeats[k] + (k > 0 && c.repeats(axis, k) ? 1 : 0);
  for (size_t first = 1, last = 1; first < n; first = last + 1) {
    for (last = first; last < n && c.repeats(axis, last);) ++last;
    if (last < first + shortest) continue;
    const Sides sides{first - std::min(first, beside), std::min(n, last + beside)};
    const std::optional<double> before = chance_of(repeats, sides.begin, first), after = chance_of(repeats, last, sides.end);
    if (!before && !after) continue;
    const auto length = static_cast<double>(last - first);
    const double of_all = (repeats[n] - length) / static_cast<double>(n);
    const double chance = std::max({before.value_or(0.0), after.value_or(0.0), of_all});
    if (chance > mostly) continue;
    const double probability = std::log(static_cast<double>(n)) + length * std::log(chance);
    const FrozenAxis run{axis, first, last};
    if (probability < std::log(by_chance) && another_goes_on(c, run, sides)) out.push_back(run);
  }
}

/// The longest run of one value.
FrozenAxis longest_run(const SixAxes& c, size_t axis) {
  FrozenAxis longest{axis, 0, 0};
  for (size_t first = 0, last = 0; first < c.size(); first = last) {
    for (last = first + 1; last < c.size() && c.repeats(axis, last);) ++last;
    if (last - first > longest.last - longest.first) longest = {axis, first, last};
  }
  return longest;
}

/// Noise in steps that the digits resolve: second differences are no smaller than first ones, as those of smooth motion are, and the values
/// are many.
bool is_noisy(const SixAxes& c, size_t axis) {
  std::vector<double> steps, bends;
  std::set<double> values;
  for (size_t k = 0; k + 1 < c.size(); ++k) {
    steps.push_back(std::abs(c.at(axis, k + 1) - c.at(axis, k)));
    if (values.size() < many_values) values.insert(c.at(axis, k));
  }
  add_noise(c, axis, 0, c.size(), bends);
  const double bend = core::median(std::move(bends), 0.0);
  return values.size() == many_values && bend > 0.0 && bend >= core::median(std::move(steps), 0.0);
}

}  // namespace

std::vector<size_t> standing_axes(const std::vector<Eigen::Vector3d>& gyro, const std::vector<Eigen::Vector3d>& accelerometer) {
  std::vector<size_t> out;
  const SixAxes columns(gyro, accelerometer);
  if (columns.size() < fewest_standing) return out;
  for (size_t axis = 0; axis < six; ++axis) {
    const FrozenAxis run = longest_run(columns, axis);
    if (run.first < fewest_beside && columns.size() - run.last < fewest_beside) out.push_back(axis);
  }
  if (out.empty()) return out;
  const auto any_is_noisy = [&](size_t sensor) {
    return is_noisy(columns, sensor) || is_noisy(columns, sensor + 1) || is_noisy(columns, sensor + 2);
  };
  if (!any_is_noisy(0) || !any_is_noisy(3)) out.clear();
  return out;
}

std::vector<FrozenAxis> frozen_axes(const std::vector<Eigen::Vector3d>& gyro, const std::vector<Eigen::Vector3d>& accelerometer) {
  std::vector<FrozenAxis> out;
  const SixAxes columns(gyro, accelerometer);
  for (size_t axis = 0; axis < six; ++axis) find_in(columns, axis, out);
  return out;
}

}  // namespace swath::io
