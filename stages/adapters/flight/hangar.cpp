// SPDX-License-Identifier: GPL-3.0-or-later
// Lever arms by a hangar survey.
#include <filesystem>
#include <string>
#include <vector>

#include "calib/hangar/hangar_results.h"
#include "calib/hangar/hangar_tables.h"
#include "core/config/option.h"
#include "core/error.h"
#include "io/survey/hangar_file.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "stages/adapters/adapters.h"
#include "stages/once.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

struct LeverArmOptions {
  bool hold_stations = false;
  core::Radians tilt_sigma = core::degrees(0.1);
};

template <class V>
void describe(LeverArmOptions& o, V& v) {
  v.option("hold_stations", o.hold_stations, "Takes the stations as free of error. Only for comparison: the sigmas come out far too small.",
           "Jubanski et al.");
  v.option("tilt_sigma", o.tilt_sigma, core::at_least(0), "Sigma of roll and pitch for the table of lever arms under tilt.",
           "Jubanski et al. eq 3");
}

io::HangarSurvey read(const io::Survey& survey) {
  if (!survey.hangar)
    throw core::usage_error("calib.lever_arm: the survey names no hangar file", survey.name,
                            "state hangar = \"hangar.toml\" in the survey (docs/lever-arm.md)");
  return io::read_hangar(io::resolve(survey, *survey.hangar));
}

std::vector<std::string> lever_arm_files(const LeverArmOptions&) { return {"lever_arm.json", "lever_arm.toml", "lever_arm.txt"}; }

std::vector<fs::path> hangar_files(const io::Survey& survey) {
  const io::HangarSurvey hangar = read(survey);
  std::vector<fs::path> out = io::hangar_tables(hangar);
  out.insert(out.begin(), hangar.file);
  return out;
}

void expect_hangar(const Context& context, const LeverArmOptions&) { read(context.survey); }

calib::HangarResult survey_hangar(const io::Survey& survey, const LeverArmOptions& o, const Output& to, core::Tally& tally) {
  calib::HangarResult result = calib::solve_hangar(read(survey), o.hold_stations);
  if (o.hold_stations) result.warnings.push_back("the stations were held: every sigma is far too small");
  for (const std::string& w : result.warnings) tally.count("warnings of the hangar survey", w);
  io::write_text_file(to.folder / "lever_arm.json", io::to_json(core::reported(result)));
  io::write_text_file(to.folder / "lever_arm.toml", calib::survey_lines(result));
  io::write_text_file(to.folder / "lever_arm.txt", calib::tables_of(result, o.tilt_sigma.value));
  return result;
}

}  // namespace

Entry lever_arm_stage() {
  return once<survey_hangar>("calib.lever_arm",
                             "Lever arms of IMU, scanner and antenna by a hangar survey with a total station, with their covariance.",
                             {.check = expect_hangar, .inputs = hangar_files, .products = lever_arm_files});
}

}  // namespace swath::stages
