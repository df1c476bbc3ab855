// SPDX-License-Identifier: GPL-3.0-or-later
// A survey stage as a piece of the work folder: done once, and taken up again with what it handed on.
#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/work/piece_record.h"
#include "pipeline/work/time_spent.h"
#include "stages/stage.h"

namespace swath::pipeline {

/// What the report says of a survey stage, and the files that it has made.
struct SurveyPiece {
  core::Tally tally;
  core::Value findings = core::Value::object();
  TimeSpent time{};
  std::vector<PieceFile> files;
};

bool is_survey_piece_done(const std::filesystem::path& folder);

/// Runs the stage, which puts its products into `folder`. What it has finished so far is kept as it goes: a stage may take hours, and look
/// for its own files. Without `keep` it is done again by the next run.
SurveyPiece run_survey_piece(const stages::Stage& stage, stages::Context& context, const std::filesystem::path& folder, bool keep = true);

/// The same of a stage that is done: the context gets what it handed on.
SurveyPiece resume_survey_piece(stages::Context& context, const std::filesystem::path& folder);

}  // namespace swath::pipeline
