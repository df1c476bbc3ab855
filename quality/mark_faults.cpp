// SPDX-License-Identifier: GPL-3.0-or-later
// Medians in place of an adjustment: up to half of the readings of a mark or a line may be wrong. Lines are judged first, by the median of
// their marks; all of them together only where every one of them lies to the same side beyond its sigma; then marks, by what is left.
#include "quality/mark_faults.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>

#include "core/distributions.h"
#include "core/geo/undulation.h"
#include "core/statistics.h"

namespace swath::quality {
namespace {

constexpr double beyond = 4.0;              // sigmas
constexpr double of_median = 1.2533;        // standard error of a median over that of a mean, large samples
constexpr double least_mark_sigma = 0.005;  // m: marks and points are never better known
constexpr size_t least_marks = 3;           // of a line that is judged
constexpr size_t least_lines = 3;           // of a mark of which one line may say otherwise

std::string text(const char* format, const std::string& who, double difference, double sigma, size_t n) {
  char out[300];
  std::snprintf(out, sizeof out, format, who.c_str(), std::abs(difference), difference < 0 ? "below" : "above", n, sigma);
  return out;
}

struct Group {
  std::vector<double> difference, sigma;
};

/// The points' own sigma is shared by a line's readings, the marks' and the scatter are not.
double sigma_of(const Group& g, double mark_sigma, double scatter) {
  const double own = core::median(g.sigma, 0.0), each = std::max({mark_sigma, scatter, least_mark_sigma});
  return std::hypot(own, of_median * each / std::sqrt(static_cast<double>(g.difference.size())));
}

/// Differences to the side of `own` and at least half as large.
size_t agreeing(const std::vector<double>& differences, double own) {
  return static_cast<size_t>(std::count_if(differences.begin(), differences.end(), [own](double d) { return d * own > 0.5 * own * own; }));
}

std::string seen_in(size_t agree, size_t all) {
  if (all == 1) return "the line that shows it";
  return (agree == all ? "all of the " : std::to_string(agree) + " of the ") + std::to_string(all) + " lines that show it";
}

/// The unit that heights of marks are in, where all of them are one factor of the ground's: feet for metres, or metres for feet. Empty:
/// neither. US survey feet differ by 2 ppm, which no heights show.
std::string foreign_unit(const std::vector<CheckMark>& marks, const std::vector<MarkReading>& readings) {
  constexpr double foot = 0.3048, tolerance = 0.01, lowest = 3.0;  // m; of the factor; m: of lower ground the ratio says little
  std::map<int, std::vector<double>> ratios;
  for (const MarkReading& r : readings) {
    const double height = marks[static_cast<size_t>(r.mark)].at.z(), ground = height + static_cast<double>(r.difference);
    if (std::abs(ground) > lowest) ratios[r.mark].push_back(height / ground);
  }
  if (ratios.size() < least_marks) return {};
  for (const auto& [factor, is, of] : {std::tuple(1.0 / foot, "feet", "metres"), std::tuple(foot, "metres", "feet")}) {
    std::vector<double> all;
    for (const auto& [mark, own] : ratios) all.push_back(core::median(own));
    const auto fit = std::count_if(all.begin(), all.end(), [&](double r) { return std::abs(r / factor - 1.0) < tolerance; });
    if (5 * static_cast<size_t>(fit) < 4 * all.size()) continue;  // one mark of five may be wrong besides
    char out[400];
    std::snprintf(out, sizeof out,
                  "the heights of the check points are %.4g times those of the ground (%zu of %zu within 1 %%): they are in %s, and the "
                  "survey's in %s: convert them, or name the CRS of the check points with its unit of heights",
                  core::median(all), static_cast<size_t>(fit), all.size(), is, of);
    return out;
  }
  return {};
}

/// What to look for where all lines lie `common` m above the check points.
std::string advice_on(double common, double undulation) {
  constexpr double least = 5.0;  // m: below it other causes are as likely
  if (!(std::abs(undulation) > least) || std::abs(std::abs(common) - std::abs(undulation)) > core::like_geoid)
    return "compare geoid, height system and antenna heights";
  char out[500];
  const bool is_by_undulation = common * undulation < 0.0;  // heights above the geoid are less by the undulation
  std::snprintf(
      out, sizeof out, "the geoid lies %.1f m %s the ellipsoid there: %s", std::abs(undulation), undulation > 0.0 ? "above" : "below",
      is_by_undulation ? "either the check points' heights are ellipsoidal (state crs of their [[control]] with +ellipsoidal), or those of "
                         "the trajectory or cloud are above the geoid (export or state them so)"
                       : "either the check points' heights are above the geoid (state crs of their [[control]] with its vertical part), or "
                         "those of the cloud are ellipsoidal (state crs of its [[points]] with +ellipsoidal)");
  return out;
}

}  // namespace

MarkFaults find_faults(const std::vector<CheckMark>& marks, const std::vector<MarkReading>& readings,
                       const std::function<double()>& undulation) {
  MarkFaults out;
  if (readings.empty()) return out;
  std::map<int, Group> lines;
  std::vector<double> mark_sigmas;
  for (const MarkReading& r : readings) {
    Group& g = lines[r.line];
    g.difference.push_back(static_cast<double>(r.difference));
    g.sigma.push_back(static_cast<double>(r.sigma));
    mark_sigmas.push_back(marks[static_cast<size_t>(r.mark)].sigma);
  }
  const double mark_sigma = core::median(mark_sigmas, 0.0);
  std::map<int, double> offset;
  for (const auto& [line, g] : lines) offset[line] = core::middle(g.difference);
  std::vector<double> rest;
  for (const MarkReading& r : readings) rest.push_back(std::abs(static_cast<double>(r.difference) - offset[r.line]));
  const double scatter = core::mad_to_sigma * core::median(rest, 0.0);

  const std::string unit = foreign_unit(marks, readings);
  bool all_above = true, all_below = true;
  size_t judged = 0;
  for (const auto& [line, g] : lines) {
    const double sigma = sigma_of(g, mark_sigma, scatter);
    out.lines.push_back({line, g.difference.size(), offset[line], sigma});
    if (g.difference.size() < least_marks) continue;
    ++judged;
    all_above = all_above && offset[line] > beyond * sigma;
    all_below = all_below && offset[line] < -beyond * sigma;
  }
  if (!unit.empty()) {  // the other faults would be its consequences
    out.named.push_back({"check.heights", unit});
    return out;
  }
  if (judged > 0 && (all_above || all_below)) {
    std::vector<double> offsets, sigmas;
    for (const LineAtMarks& l : out.lines)
      if (l.marks >= least_marks) {
        offsets.push_back(l.difference);
        sigmas.push_back(l.sigma);
      }
    out.common = core::middle(offsets);
    out.named.push_back({"check.heights", text("%s lies %.3f m %s the check points on all of its %zu lines (sigma %.3f m): ", "the ground",
                                               out.common, core::median(sigmas), judged) +
                                              advice_on(out.common, undulation ? undulation() : std::nan(""))});
  }
  std::map<int, bool> is_shifted;
  for (const LineAtMarks& l : out.lines) {
    const double own = l.difference - out.common;
    is_shifted[l.line] = l.marks >= least_marks && lines.size() > 1 && std::abs(own) > beyond * l.sigma;
    if (is_shifted[l.line])
      out.named.push_back(
          {"check.line", text("%s lies %.3f m %s its %zu check points (sigma %.3f m), other lines do not: look at its trajectory",
                              "line " + std::to_string(l.line), own, l.sigma, l.marks)});
  }
  // What a line has in common is its own; of a line with few marks nothing can be said.
  std::map<int, Group> of_mark;  // differences, and the scatter of the points around the mark
  for (const MarkReading& r : readings) {
    const double line = lines[r.line].difference.size() >= least_marks ? offset[r.line] : out.common;
    of_mark[r.mark].difference.push_back(static_cast<double>(r.difference) - line);
    of_mark[r.mark].sigma.push_back(static_cast<double>(r.scatter));
  }
  if (of_mark.size() < least_marks) return out;  // of two that differ nothing says which is wrong
  for (const auto& [m, group] : of_mark) {
    const CheckMark& mark = marks[static_cast<size_t>(m)];
    const double own = core::middle(group.difference);
    const double sigma = std::hypot(mark.sigma, std::max({scatter, least_mark_sigma, core::median(group.sigma)}));
    const size_t agree = agreeing(group.difference, own), all = group.difference.size();
    if (std::abs(own) <= beyond * sigma || !(agree == all || (all >= least_lines && agree + 1 == all))) continue;
    char sentence[400];
    std::snprintf(sentence, sizeof sentence,
                  "at check point %s (%s) the ground lies %.3f m %s its height in %s (sigma %.3f m): check its record", mark.name.c_str(),
                  mark.place.c_str(), std::abs(own), own < 0 ? "below" : "above", seen_in(agree, all).c_str(), sigma);
    out.named.push_back({"check.mark", sentence});
  }
  return out;
}

}  // namespace swath::quality
