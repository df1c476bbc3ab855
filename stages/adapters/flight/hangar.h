// SPDX-License-Identifier: GPL-3.0-or-later
// Lever arms by a hangar survey.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/hangar/hangar_results.h"
#include "core/config/option.h"
#include "stages/once.h"

namespace swath::stages {

struct LeverArmOptions {
  bool hold_stations = false;
};

template <class V>
void describe(LeverArmOptions& o, V& v) {
  v.option("hold_stations", o.hold_stations, "Takes the stations as free of error. Only for comparison: the sigmas come out far too small.",
           "Jubanski et al.");
}

calib::HangarResult survey_hangar(const io::Survey& survey, const LeverArmOptions& o, const Output& to, core::Tally& tally);
void expect_hangar(const Context& context, const LeverArmOptions&);
std::vector<std::filesystem::path> hangar_files(const io::Survey& survey);
std::vector<std::string> lever_arm_files(const LeverArmOptions&);

}  // namespace swath::stages
