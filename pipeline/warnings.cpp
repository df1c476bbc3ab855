// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/warnings.h"

#include <algorithm>

#include "core/error.h"
#include "io/las/las_box.h"
#include "pipeline/limits.h"

namespace swath::pipeline {
namespace {

using core::Value;

constexpr std::string_view box_code = "points.outside_box", damage_code = "work.damaged", geometry_code = "geometry.contradiction",
                           mistake_code = "geometry.mistake";

/// An example for each file, and one for those that the report counts without.
void add_boxes(const Value& wrong, std::vector<Warning>& out) {
  const auto& examples = wrong.find("examples")->items();
  for (const Value& example : examples) out.push_back({std::string(box_code), example.as_text(), {}});
  const auto more = wrong.find("count")->as_int() - static_cast<std::int64_t>(examples.size());
  if (more > 0)
    out.push_back({std::string(box_code),
                   "and " + std::to_string(more) + " more " + io::wrong_box + ": report.json",
                   {{"more", static_cast<double>(more), {}}}});
}

/// The sentences of what is named are the last ones.
void add_geometry(const Value& geometry, std::vector<Warning>& out) {
  const Value* named = geometry.find("named");
  const auto& sentences = geometry.find("warnings")->items();
  const size_t mistakes = named ? std::min(named->items().size(), sentences.size()) : 0;
  for (size_t k = 0; k < sentences.size(); ++k)
    out.push_back({std::string(k + mistakes < sentences.size() ? geometry_code : mistake_code), sentences[k].as_text(), {}});
}

}  // namespace

const std::vector<WarningKind>& warning_kinds() {
  static const std::vector<WarningKind> kinds{
      {"geometry.contradiction", "Lines, heights or headings of the flight contradict one another more than their accuracy allows.",
       "See the checks of quality.geometry in report.json, and the warnings geometry.mistake beside this one."},
      {"geometry.mistake", "A usual mistake in the description of the survey explains the contradictions.",
       "The sentence ends with what to change in survey.toml; run again and compare."},
      {"limit.contradictions", "quality.geometry has more warnings than run.limits.contradictions allows.",
       "Resolve the warnings of the geometry, or raise the limit."},
      {"limit.line_difference", "Lines differ on smooth ground by more than run.limits.line_difference.",
       "Check calibration and trajectory (quality.geometry, calib.adjust), or raise the limit."},
      {"limit.outside", "More returns lie outside the trajectory than run.limits.outside allows.",
       "Compare the times of laser and trajectory with `swath info`, or raise the limit."},
      {"limit.truth_rms", "Points are farther from the truth than run.limits.truth_rms.",
       "See report.truth in report.json, or raise the limit."},
      {"limit.voids", "The terrain model has more holes than run.limits.voids allows.",
       "See the reasons of the voids in the quality raster, take larger cells, or raise the limit."},
      {box_code, "Points lie well outside the box that their file's header states.",
       "The points are used as they are; have the file written again, for other programs trust the box."},
      {damage_code, "Pieces of an earlier run's work were changed or damaged, and were done again.",
       "Look for what writes into the work folder, and check the disk."},
  };
  return kinds;
}

std::string warning_help(const std::string& code) {
  std::string out;
  std::vector<std::string> codes;
  for (const WarningKind& k : warning_kinds()) {
    codes.emplace_back(k.code);
    if (code.empty()) out += std::string(k.code) + std::string(24 - k.code.size(), ' ') + std::string(k.meaning) + "\n";
    if (code == k.code) out = code + ": " + std::string(k.meaning) + "\n\n" + std::string(k.remedy) + "\n";
  }
  if (!out.empty()) return out;
  const std::string near = core::nearest(code, codes);
  throw core::usage_error("'" + code + "' is not a code of a warning", "",
                          near.empty() ? "`swath warnings` lists them" : "did you mean '" + near + "'?");
}

std::string warning_page() {
  std::string out = "| code | meaning | what to do |\n|---|---|---|\n";
  for (const WarningKind& k : warning_kinds())
    out += "| `" + std::string(k.code) + "` | " + std::string(k.meaning) + " | " + std::string(k.remedy) + " |\n";
  return out;
}

std::vector<Warning> warnings_in(const Value& report) {
  std::vector<Warning> out;
  if (const Value* damaged = report.find("pieces_damaged"); damaged && damaged->as_int() > 0)
    out.push_back({std::string(damage_code),
                   std::to_string(damaged->as_int()) + " pieces of an earlier run were damaged and were done again",
                   {{"pieces", damaged->as_number(), {}}}});
  for (const Value& stage : report.find("stages")->items())
    if (const Value* tally = stage.find("tally"))
      if (const Value* wrong = tally->find(io::wrong_box)) add_boxes(*wrong, out);
  if (const Value* geometry = report.find("geometry")) add_geometry(*geometry, out);
  if (const Value* limits = report.find("limits"))
    for (Warning& w : missed_limits(*limits)) out.push_back(std::move(w));
  return out;
}

}  // namespace swath::pipeline
