// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/warnings.h"

#include "core/error.h"

namespace swath::pipeline {

const std::vector<WarningKind>& warning_kinds() {
  static const std::vector<WarningKind> kinds{
      {"check.heights", "The ground lies to one side of the check points on all lines, beyond four sigmas.",
       "Compare geoid, height system, datum and antenna heights of check points and survey."},
      {"check.line", "One flight line differs from its check points beyond four sigmas, and other lines do not.",
       "Look at the line's trajectory (report, quality.geometry); calib.strips can adjust it."},
      {"check.mark", "One check point differs from the ground of all lines that show it, beyond four sigmas.",
       "Look at its record in the field book; it may be set on something that is no ground."},
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
      {"points.outside_box", "Points lie well outside the box that their file's header states.",
       "The points are used as they are; have the file written again, for other programs trust the box."},
      {"work.damaged", "Pieces of an earlier run's work were changed or damaged, and were done again.",
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

}  // namespace swath::pipeline
