// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/verdict.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "report/html.h"

namespace swath::calib {
namespace {

using calib::Adjustment;
using calib::Parameter;

std::string sigma_number(const calib::Estimate& e) { return report::number_text(e.sigma / words_of(e.parameter).sigma_size, 1); }

/// Runs of parameters that share unit and group are said in one breath: "boresight roll, pitch and heading ... to 1, 2 and 3 arcsec".
std::string known_to(const Adjustment& a, const std::vector<Parameter>& parameters) {
  std::vector<std::string> names, sigmas;
  for (const Parameter p : parameters) {
    std::string name(words_of(p).name);
    const size_t blank = name.rfind(' ');
    names.push_back(names.empty() || blank == std::string::npos ? name : name.substr(blank + 1));
    sigmas.push_back(sigma_number(a.estimates[static_cast<size_t>(p)]));
  }
  return joined(names) + (names.size() == 1 ? " is known to " : " are known to ") + joined(sigmas) + " " +
         std::string(words_of(parameters.front()).sigma_unit);
}

/// Parameters by group, those of the boresight first, then the lever arm, then each alone.
std::vector<std::vector<Parameter>> groups_of(const Adjustment& a) {
  std::vector<std::vector<Parameter>> out;
  const auto add = [&](int first, int last) {
    std::vector<Parameter> group;
    for (int k = first; k <= last; ++k)
      if (is_delivered(a, parameter_at(k))) group.push_back(parameter_at(k));
    if (!group.empty()) out.push_back(std::move(group));
  };
  add(calib::boresight_roll, calib::boresight_heading);
  for (int k = calib::range_offset; k <= calib::latency; ++k) add(k, k);
  add(calib::lever_forward, calib::lever_down);
  return out;
}

std::string capitalised(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

/// Ends with a full stop.
std::string sentence(std::string text) {
  if (!text.empty() && text.back() != '.' && text.back() != '!' && text.back() != '?') text += '.';
  return text;
}

/// What the findings say that refuse one of the parameters [first, last], and how to cure it.
struct Refusal {
  std::vector<std::string> what, cures;
};
Refusal refusals(const Adjustment& a, int first, int last) {
  Refusal out;
  for (const calib::Finding& f : a.findings) {
    const bool concerns = f.refuses && (f.parameters.empty() || std::any_of(f.parameters.begin(), f.parameters.end(),
                                                                            [&](Parameter p) { return p >= first && p <= last; }));
    if (!concerns) continue;
    out.what.push_back(f.what);
    if (!f.cure.empty() && std::find(out.cures.begin(), out.cures.end(), f.cure) == out.cures.end()) out.cures.push_back(f.cure);
  }
  return out;
}

std::string not_calibrated(const Refusal& r) {
  std::string text = "Not calibrated: ";
  for (size_t k = 0; k < r.what.size(); ++k) text += (k ? "; " : "") + r.what[k];
  text = sentence(text);
  for (const std::string& cure : r.cures) text += " " + sentence(capitalised(cure));
  return text;
}

}  // namespace

std::string joined(const std::vector<std::string>& items) {
  std::string out;
  for (size_t k = 0; k < items.size(); ++k) out += (k == 0 ? "" : k + 1 == items.size() ? " and " : ", ") + items[k];
  return out;
}

bool is_refused(const Adjustment& a, Parameter parameter) {
  return std::any_of(a.findings.begin(), a.findings.end(), [&](const calib::Finding& f) {
    // A refusal that names no parameter is of all.
    return f.refuses && (f.parameters.empty() || std::find(f.parameters.begin(), f.parameters.end(), parameter) != f.parameters.end());
  });
}

bool is_delivered(const Adjustment& a, Parameter parameter) {
  const calib::Estimate& e = a.estimates[static_cast<size_t>(parameter)];
  return e.estimated && std::isfinite(e.value) && std::isfinite(e.sigma) && !is_refused(a, parameter);
}

CalibrationVerdict verdict_of(const Adjustment& a) {
  CalibrationVerdict out;
  const auto groups = groups_of(a);
  bool boresight_lost = false;
  for (int k = calib::boresight_roll; k <= calib::boresight_heading; ++k)
    boresight_lost = boresight_lost || (a.estimates[static_cast<size_t>(k)].estimated && !is_delivered(a, parameter_at(k)));
  if (groups.empty() || boresight_lost) {
    Refusal r = refusals(a, calib::boresight_roll, boresight_lost ? calib::boresight_heading : calib::latency);
    if (r.what.empty()) r.what.push_back(boresight_lost ? "the boresight came out without a sigma" : "no parameter was estimated");
    out.text = not_calibrated(r);
    return out;
  }

  out.calibrated = true;
  out.tone = report::Tone::good;
  std::string text;
  for (size_t g = 0; g < groups.size(); ++g) {
    text += (g == 0 ? "" : ", ") + std::string(groups[g].front() >= calib::lever_forward ? "the " : "") + known_to(a, groups[g]);
    if (g == 0) text += " (one sigma)";
  }
  // "..., the range offset is known to 8 mm" reads better without the second verb.
  for (const std::string_view verb : {std::string_view(" is known to "), std::string_view(" are known to ")})
    for (size_t at = text.find(verb, text.find("(one sigma)")); at != std::string::npos; at = text.find(verb, at))
      text.replace(at, verb.size(), " to ");
  out.text = "Calibrated: " + text;

  std::vector<std::string> coarse;
  for (int k = 0; k < estimated_count; ++k)
    if (is_delivered(a, parameter_at(k)) && a.estimates[static_cast<size_t>(k)].grade == calib::Grade::coarse)
      coarse.push_back("the " + std::string(words_of(parameter_at(k)).name));
  if (!coarse.empty()) {
    out.tone = report::Tone::caution;
    out.text += "; coarse " + std::string(coarse.size() == 1 ? "is " : "are ") + joined(coarse);
  }
  std::vector<std::string> lost;
  for (int k = 0; k < estimated_count; ++k)
    if (a.estimates[static_cast<size_t>(k)].estimated && !is_delivered(a, parameter_at(k)))
      lost.push_back("the " + std::string(words_of(parameter_at(k)).name));
  if (!lost.empty()) {
    out.tone = report::Tone::caution;
    out.text +=
        "; not determined, and left at " + std::string(lost.size() == 1 ? "its start value: " : "their start values: ") + joined(lost);
  }
  const auto disagree = std::count_if(a.control.begin(), a.control.end(), [](const calib::ControlResidual& c) { return c.rejected; });
  if (disagree > 0) {
    out.tone = report::Tone::caution;
    out.text += "; " + std::to_string(disagree) + " of " + std::to_string(a.control.size()) + " surveyed points disagree with the flight";
  }
  out.text += ".";
  if (std::any_of(a.findings.begin(), a.findings.end(), [](const calib::Finding& f) { return !f.refuses; })) {
    out.tone = report::Tone::caution;
    out.text += " Read the warnings below.";
  }
  return out;
}

CalibrationVerdict verdict_of_strips(const Adjustment& a, const calib::PlaneDifferences& d) {
  constexpr double centimetre = 0.01;
  CalibrationVerdict out;
  out.tone = d.all.rms_after <= d.all.rms_before ? report::Tone::good : report::Tone::bad;
  out.text = "Lines meet within " + report::number_text(d.all.rms_after / centimetre, 1) + " cm on " + report::count_text(d.all.planes) +
             " pairs of looks at planes (" + report::number_text(d.all.rms_before / centimetre, 1) + " cm before; rms)";
  const auto disagree = std::count_if(a.control.begin(), a.control.end(), [](const calib::ControlResidual& c) { return c.rejected; });
  if (disagree > 0)
    out.text += "; " + std::to_string(disagree) + " of " + std::to_string(a.control.size()) + " surveyed points disagree with the flight";
  if (a.control.empty()) out.text += "; without surveyed points the whole block keeps the trajectory's mean error";
  out.text += ".";
  if (disagree > 0 || !a.findings.empty()) out.tone = std::max(out.tone, report::Tone::caution);
  if (!a.findings.empty()) out.text += " Read the warnings below.";
  return out;
}

}  // namespace swath::calib
