// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/read_survey.h"

#include <algorithm>

#include "core/config/option_visitors.h"
#include "io/copc/ept.h"
#include "io/survey/calibration_file.h"
#include "io/survey/camera_checks.h"
#include "io/survey/survey_checks.h"
#include "io/survey/tree_kind.h"
#include "io/text/value_file.h"

namespace swath::io {
namespace {

using core::Fault;
using core::Value;

/// Noise of single records is the survey's matter where it states it: the calibration's records were others.
void keep_stated_noise(const core::SensorSigma& stated, core::SensorSigma& sigma) {
  const auto keep = [&](const char* key, auto core::SensorSigma::*value) {
    if (std::find(stated.stated.begin(), stated.stated.end(), key) != stated.stated.end()) sigma.*value = stated.*value;
  };
  keep("range", &core::SensorSigma::range);
  keep("scan_angle", &core::SensorSigma::scan_angle);
  keep("time", &core::SensorSigma::time);
  keep("beam_divergence", &core::SensorSigma::beam_divergence);
}

}  // namespace

Survey read_survey(const core::Value& tree, const std::filesystem::path& folder, RecordsIn records) {
  if (!tree.is_object()) throw core::usage_error("a survey is a table", tree.where.text());
  if (records == RecordsIn::files) require_kind(tree, TreeKind::survey, tree.where.file);
  Survey survey;
  survey.folder = folder;
  std::vector<Fault> faults;
  core::read_options(core::described(survey), tree, "", faults);
  check_survey(survey, tree, faults, records);
  check_cameras(survey, tree, faults);
  std::stable_sort(faults.begin(), faults.end(), [](const Fault& a, const Fault& b) {
    return std::pair(a.where.line, a.where.column) < std::pair(b.where.line, b.where.column);
  });
  core::throw_if_any(faults);
  expand_clouds(survey);
  if (const Value* stated = tree.find("sigma")) note_stated(*stated, survey.sigma);
  if (survey.calibration_file) {
    const core::SensorSigma stated = survey.sigma;
    load_calibration(resolve(survey, *survey.calibration_file), survey.calibration, survey.sigma);
    keep_stated_noise(stated, survey.sigma);
  }
  return survey;
}

Survey read_survey(const std::filesystem::path& file) { return read_survey(read_value_file(file), file.parent_path()); }

}  // namespace swath::io
