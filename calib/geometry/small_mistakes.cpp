// SPDX-License-Identifier: GPL-3.0-or-later
// No published source. A usual mistake has no free value and is preferred to a fitted one that explains little more.
#include "calib/geometry/small_mistakes.h"

#include <algorithm>
#include <cmath>

#include "calib/words.h"
#include "core/config/units.h"

namespace swath::calib {
namespace {

constexpr double sure_usual = 20.0, sure_fitted = 32.0;     // gains: 4.5 and, with the choice among several, 5 sigmas
constexpr double less = 0.4;                                // of those, where something is known to be wrong
constexpr double per_value = 4.0;                           // of the gain, for each value that was fitted ...
constexpr double per_unstated = 1.0;                        // ... and of those that are stated as zero: they were left out
constexpr double gain_as_good = 6.0, share_as_good = 0.05;  // of the gain: planes that lie apart do not show it more truly
constexpr double longest_lever = 3.0;                       // m: no scanner is farther from its IMU
constexpr double smallest = 0.08;                           // m on the ground
constexpr double largest = 20.0;                            // m on the ground: beyond, another mistake is at work
constexpr double largest_scale = 0.05;                      // off 1: beyond, it is a unit
constexpr double surely = 4.0;                              // sigmas of a fitted value that is said
constexpr size_t most = 3;

SmallVector values_of(const core::Calibration& c) {
  SmallVector v;
  v << c.roll.value, c.pitch.value, c.heading.value, c.lever_arm_scanner[0].value, c.lever_arm_scanner[1].value,
      c.lever_arm_scanner[2].value, c.range_offset.value, c.range_scale, c.scan_offset.value, c.scan_scale, c.latency.value;
  return v;
}

core::Calibration calibration_of(const SmallVector& v) {
  core::Calibration c;
  c.roll.value = v[boresight_roll], c.pitch.value = v[boresight_pitch], c.heading.value = v[boresight_heading];
  for (size_t i = 0; i < 3; ++i) c.lever_arm_scanner[i].value = v[lever_forward + static_cast<int>(i)];
  c.range_offset.value = v[range_offset], c.range_scale = v[range_scale];
  c.scan_offset.value = v[scan_offset], c.scan_scale = v[scan_scale], c.latency.value = v[latency];
  return c;
}

/// Metres on the ground that an error moves returns by, about.
double moved_by(const SmallVector& e, const FlownAt& f) {
  constexpr double edge = 0.35;  // rad, from nadir to the swath's edge
  const double angles = (std::abs(e[boresight_roll]) + std::abs(e[boresight_pitch]) + edge * std::abs(e[boresight_heading]) +
                         std::abs(e[scan_offset]) + edge * std::abs(e[scan_scale]) + std::abs(e[range_scale])) *
                        f.range;
  return angles + e.segment<3>(lever_forward).norm() + std::abs(e[range_offset]) + std::abs(e[latency]) * f.speed;
}

bool is_plausible(const SmallVector& error, const FlownAt& flown) {
  const double moved = moved_by(error, flown);
  return moved > smallest && moved < largest && std::abs(error[range_scale]) < largest_scale;
}

struct Group {
  const char *name, *what, *cure;
  std::vector<Parameter> free;
  bool needs_heights = false;
};

const std::vector<Group>& groups() {
  static const std::vector<Group> all{
      {"height_offset", "with all heights", "compare the height systems of trajectory and control", {lever_down}, true},
      {"boresight", "with a boresight of", "calibrate the boresight, or state it in [calibration]", {boresight_roll}},
      {"boresight", "with a boresight of", "calibrate the boresight, or state it in [calibration]", {boresight_pitch}},
      {"heading_offset",
       "with headings of trajectory or boresight changed:",
       "compare the trajectory's headings with true north, or state the boresight heading in [calibration]",
       {boresight_heading}},
      {"boresight",
       "with a boresight of",
       "calibrate the boresight, or state it in [calibration]",
       {boresight_roll, boresight_pitch, boresight_heading}},
      {"lever_arm",
       "with a lever arm of",
       "measure it again, or compare its signs, axes and unit with lever_arm_scanner of [calibration]",
       {lever_forward, lever_right}},
      {"lever_arm",
       "with a lever arm of",
       "measure it again, or compare its signs, axes and unit with lever_arm_scanner of [calibration]",
       {lever_forward, lever_right, lever_down},
       true},
      {"time_offset", "with a", "state the laser's latency in [calibration]", {latency}},
      {"scan_scale", "with a", "state scan_scale in [calibration]", {scan_scale}},
      {"range_scale", "with a", "state range_scale in [calibration]", {range_scale}},
      {"range_offset", "with a", "state range_offset in [calibration]", {range_offset}, true},
  };
  return all;
}

/// "roll 0.0504 deg" of a value.
std::string value_text(Parameter p, double value, const char* between = "") {
  static const char* const names[small_count] = {"roll",         "pitch",       "heading",     "forward",    "right",  "down",
                                                 "range_offset", "range_scale", "scan_offset", "scan_scale", "latency"};
  const bool angle = p <= boresight_heading || p == scan_offset;
  const char* const unit = angle ? " deg" : p == latency ? " s" : p == range_scale || p == scan_scale ? "" : " m";
  const char* const format = unit[0] == '\0' ? " %.5f" : angle ? " %.3f" : p == latency ? " %.4f" : " %.2f";
  return std::string(names[p]) + between + words(format, angle ? core::to_degrees(value) : value) + unit;
}

/// All three angles, or parts of the lever arm, of a group are stated as zero.
bool is_left_out(const Group& g, const SmallVector& stated) {
  if (g.free.size() < 2) return false;
  const int first = g.free.front() == boresight_roll ? boresight_roll : lever_forward;
  return stated.segment<3>(first).isZero();
}

std::string sentence(const Group& g, const SmallVector& right, const SmallVector& error) {
  std::string out = g.what;
  if (g.free.front() == lever_down)
    return out + words(" %.2f m %s", std::abs(error[lever_down]), error[lever_down] > 0 ? "higher" : "lower");
  const bool is_article = out.ends_with(" a");
  for (size_t k = 0; k < g.free.size(); ++k)
    out += (k == 0 ? " " : ", ") + value_text(g.free[k], right[g.free[k]], is_article ? " of" : "");
  return out + " (fitted)";
}

}  // namespace

std::vector<SmallExplanation> explain_small(const SmallErrors& errors, const Chain& at, const Chain& stated,
                                            const std::vector<UsualMistake>& usual, const FlownAt& flown, bool heights, bool alarmed) {
  std::vector<SmallExplanation> all;
  const SmallVector values = values_of(stated.calibration), here = values_of(at.calibration);
  const double now = errors.with(here - values).squares;
  const auto add = [&](const SmallVector& right, double gain, SmallExplanation e) {
    if (gain < (alarmed ? less : 1.0) * (e.usual ? sure_usual : sure_fitted) || !is_plausible(values - right, flown)) return;
    e.chain = stated;
    e.chain.calibration = calibration_of(right);
    e.gain = gain;
    all.push_back(std::move(e));
  };
  for (const UsualMistake& m : usual) {
    if (m.kind != UsualMistake::Kind::small) continue;
    Chain chain = stated;
    if (m.chain) m.chain(chain);
    SmallVector right = values_of(chain.calibration);
    right[boresight_heading] += m.heading;
    add(right, now - errors.with(here - right).squares, {std::string(m.name), m.what, m.cure, {}, 0, true});
  }
  for (const Group& g : groups()) {
    if (g.needs_heights && !heights) continue;
    const SmallErrors::Solution s = errors.with(here - values, g.free);
    SmallVector right = values;
    bool clear = false;
    for (const Parameter p : g.free) {
      right[p] = here[p] - s.error[p];
      clear = clear || std::abs(values[p] - right[p]) > surely * s.sigma[p];
    }
    if (!clear || (g.free.front() == lever_forward && right.segment<3>(lever_forward).norm() > longest_lever)) continue;
    const bool unstated = is_left_out(g, values);
    const double cost = (unstated ? per_unstated : per_value) * static_cast<double>(g.free.size());
    add(right, now - s.squares - cost,
        {g.name + std::string(unstated ? "_missing" : ""), sentence(g, right, values - right), g.cure, {}, 0, false});
  }
  const auto best = [&](bool of_usual) {
    double out = 0;
    for (const SmallExplanation& e : all)
      if (e.usual || !of_usual) out = std::max(out, e.gain);
    return out;
  };
  const auto is_common = [&](const SmallExplanation& e) { return alarmed && e.name == "height_offset"; };
  const double least = best(false) - std::max(gain_as_good, share_as_good * best(false));
  const bool by_usual = best(true) >= least;
  std::erase_if(all, [&](const SmallExplanation& e) { return e.gain < least || (by_usual && !e.usual && !is_common(e)); });
  std::stable_sort(all.begin(), all.end(), [](const SmallExplanation& x, const SmallExplanation& y) { return x.gain > y.gain; });
  // Many a usual mistake lifts all lines alike: that they are named by chance does not hide the plain difference of heights.
  if (const auto plain = std::find_if(all.begin(), all.end(), is_common); plain != all.end() && plain != all.begin())
    std::rotate(all.begin() + 1, plain, plain + 1);
  if (all.size() > most) all.resize(most);
  return all;
}

size_t fitted_groups() { return groups().size(); }

SmallExplanation fit_small(const SmallErrors& errors, const Chain& stated, const Chain& at, size_t group) {
  const Group& g = groups()[group];
  SmallExplanation out;
  out.chain = at;
  if (g.needs_heights || g.free.front() == latency) return out;
  const SmallErrors::Solution s = errors.with(SmallVector::Zero(), g.free);
  SmallVector right = values_of(at.calibration);
  const SmallVector before = right, values = values_of(stated.calibration);
  for (const Parameter p : g.free) right[p] -= s.error[p];
  if (std::abs(right[range_scale] - values[range_scale]) > largest_scale) return out;
  out.step = (right - before).norm() / std::max(1e-12, (right - values).norm());
  out.chain.calibration = calibration_of(right);
  out.name = g.name + std::string(is_left_out(g, values) ? "_missing" : "");
  out.what = sentence(g, right, values - right);
  out.cure = g.cure;
  return out;
}

}  // namespace swath::calib
