// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/agreement.h"

#include <cmath>

#include "report/html.h"

namespace swath::calib {

Agreement agreement_of(const calib::Adjustment& a, const TargetReading& r) {
  const calib::Estimate& e = a.estimates.at(static_cast<size_t>(r.parameter));
  Agreement out;
  out.known = is_delivered(a, r.parameter);
  if (!out.known) return out;
  out.difference = r.value - e.value;
  out.joint_sigma = std::hypot(r.sigma, e.sigma);
  out.agrees = std::abs(out.difference) <= agreement_limit * out.joint_sigma;
  return out;
}

CalibrationVerdict verdict_of(const CalibrationReport& report) {
  if (report.strips) return verdict_of_strips(report.adjustment, *report.strips);
  CalibrationVerdict out = verdict_of(report.adjustment);
  std::vector<std::string> apart;
  for (const TargetReading& r : report.readings) {
    const Agreement g = agreement_of(report.adjustment, r);
    if (g.known && !g.agrees)
      apart.push_back(std::string(words_of(r.parameter).name) + " by " +
                      report::number_text(std::abs(g.difference) / words_of(r.parameter).sigma_size, 1) + " " +
                      std::string(words_of(r.parameter).sigma_unit) + " (" +
                      report::number_text(std::abs(g.difference) / g.joint_sigma, 1) + " joint sigmas)");
  }
  if (apart.empty()) return out;
  if (out.tone == report::Tone::good) out.tone = report::Tone::caution;
  out.text += " The flat target contradicts it: " + joined(apart) + ".";
  return out;
}

}  // namespace swath::calib
