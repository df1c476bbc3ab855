// SPDX-License-Identifier: GPL-3.0-or-later
// The variance that an estimate loses by further observations is the variance of its change (Hausman 1978): a change beyond it contradicts
// the sigmas. Deviation: the mean over a line is tested with the mean of the pointwise variances, as if its errors were one error, which
// they nearly are over a line; where they are not, the test is milder.
#include "calib/network/doubtful_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "calib/report_units.h"
#include "calib/words.h"
#include "core/distributions.h"

namespace swath::calib {
namespace {

constexpr double line_false_alarms = 1e-3;  // probability of one in a survey whose sigmas are right
constexpr double least_expected = 0.1;      // of the sigma before: sigmas are no better known than so
constexpr double many_out = 0.25;           // share of a line's groups
constexpr double more_than_others = 3.0;
constexpr double fewest_out = 10.0;

struct ChangeAxis {
  const char *name, *opposite, *unit;  ///< opposite: of a negative change; "" where its sign says it
  double size;
};
constexpr std::array<ChangeAxis, 6> change_axes{{{"north", "south", "cm", centimetre},
                                                 {"east", "west", "cm", centimetre},
                                                 {"down", "up", "cm", centimetre},
                                                 {"in roll", "", "arcsec", arc_second},
                                                 {"in pitch", "", "arcsec", arc_second},
                                                 {"in heading", "", "arcsec", arc_second}}};

/// Mean change of one component along a line, and its sigma.
struct MeanChange {
  double mean = 0.0, sigma = 0.0;
  double ratio() const { return sigma > 0.0 ? std::abs(mean) / sigma : 0.0; }
};

MeanChange change_of(const LineCorrection& c, size_t axis) {
  MeanChange out;
  double variance = 0.0;
  for (size_t i = 0; i < c.time.size(); ++i) {
    const double before = c.apriori[i][axis] * c.apriori[i][axis], after = c.sigma[i][axis] * c.sigma[i][axis];
    out.mean += c.value[i][axis];
    variance += std::max(before - after, least_expected * least_expected * before);
  }
  const double n = std::max(1.0, static_cast<double>(c.time.size()));
  out.mean /= n;
  out.sigma = std::sqrt(variance / n);
  return out;
}

void find_moved(const std::vector<LineCorrection>& corrections, std::vector<Finding>& out) {
  const double tests = std::max(1.0, static_cast<double>(change_axes.size() * corrections.size()));
  const double critical = core::normal_quantile(1.0 - 0.5 * line_false_alarms / tests);
  for (const LineCorrection& c : corrections) {
    MeanChange worst;
    size_t at = 0;
    for (size_t axis = 0; axis < change_axes.size(); ++axis)
      if (const MeanChange change = change_of(c, axis); change.ratio() > worst.ratio()) worst = change, at = axis;
    if (worst.ratio() <= critical) continue;
    const ChangeAxis& axis = change_axes[at];
    const bool turned = worst.mean < 0.0 && *axis.opposite;
    out.push_back(
        {words("line %d: the surfaces move the smoother's trajectory by %.1f %s %s, %.1f times the sigma of such a change", c.line,
               (turned ? -worst.mean : worst.mean) / axis.size, axis.unit, turned ? axis.opposite : axis.name, worst.ratio()),
         "look at the fixes, the antenna's lever arm and the times of this line's records; sigmas of this line are too small",
         {},
         false});
  }
}

void find_left_out(const std::vector<TieLine>& lines, const std::vector<GroupResidual>& groups, std::vector<Finding>& out) {
  std::vector<double> all(lines.size(), 0.0), without(lines.size(), 0.0);
  double sum = 0.0, sum_without = 0.0;
  for (const GroupResidual& g : groups) {
    all[g.line] += 1.0, sum += 1.0;
    if (g.rejected) without[g.line] += 1.0, sum_without += 1.0;
  }
  for (size_t l = 0; l < lines.size(); ++l) {
    const double others = (sum_without - without[l]) / std::max(1.0, sum - all[l]);
    if (without[l] < fewest_out || without[l] < many_out * all[l] || without[l] < more_than_others * others * all[l]) continue;
    out.push_back(
        {words("line %d: %.0f of its %.0f groups on planes do not fit the other lines and are left out", lines[l].id, without[l], all[l]),
         "look at the times, the line number and the calibration of this line's returns; its trajectory is that of IMU and GNSS "
         "where no group is left",
         {},
         false});
  }
}

}  // namespace

std::vector<Finding> doubtful_lines(const std::vector<TieLine>& lines, const std::vector<LineCorrection>& corrections,
                                    const std::vector<GroupResidual>& groups) {
  std::vector<Finding> out;
  find_moved(corrections, out);
  find_left_out(lines, groups, out);
  return out;
}

}  // namespace swath::calib
