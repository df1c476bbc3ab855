// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/survey_piece.h"

#include <utility>

#include "core/config/result_visitors.h"
#include "io/text/output_file.h"
#include "pipeline/engine/account.h"
#include "pipeline/work/handed_on.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char *record_name = "survey.done", *partial_name = "files.done", *handed_on_name = "handed_on.bin";

}  // namespace

bool is_survey_piece_done(const fs::path& folder) { return fs::exists(folder / record_name); }

SurveyPiece run_survey_piece(const stages::Stage& stage, stages::Context& context, const fs::path& folder, bool keep) {
  SurveyPiece piece;
  const stages::Records::Marks before = context.records.marks();
  const Stopwatch watch(Whose::program);
  PieceRecord so_far;
  {
    const io::FinishedFiles noting([&](const fs::path& file) {
      const io::FinishedFiles apart;  // the record is not one of the stage's files
      so_far.files.push_back(piece_file(folder, file));
      write_record(folder / partial_name, so_far);
    });
    stage.run_survey(context, piece.tally, piece.findings);
    expect_balance(piece.tally, stage);
  }
  piece.time = watch.spent();
  const bool kept = keep && write_handed_on(folder / handed_on_name, before, context);
  for (const PieceFile& f : so_far.files)
    if (!fs::exists(folder / f.name)) throw damaged_work(folder / f.name);
  std::error_code absent;
  fs::remove(folder / partial_name, absent);
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path() != folder / record_name && !io::is_temporary(entry.path())) files.push_back(entry.path());
  piece.files = piece_files(folder, std::move(files));
  if (!kept) return piece;
  write_record(folder / record_name, {piece.files, core::reported(Account{0, 0, 0, piece.time, piece.tally, piece.findings})});
  return piece;
}

SurveyPiece resume_survey_piece(stages::Context& context, const fs::path& folder) {
  std::optional<PieceRecord> record = read_record(folder / record_name);
  if (!record) throw damaged_work(folder / record_name);
  read_handed_on(folder / handed_on_name, context);
  std::optional<Account> account = account_of(record->note);
  if (!account) throw damaged_work(folder / record_name);
  return {std::move(account->tally), std::move(account->findings), account->time, std::move(record->files)};
}

}  // namespace swath::pipeline
