// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/survey_piece.h"

#include <chrono>
#include <utility>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "io/text/output_file.h"
#include "pipeline/work/handed_on.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char *record_name = "survey.done", *partial_name = "files.done", *handed_on_name = "handed_on.bin";

}  // namespace

core::Value records_of(const core::Tally& tally) {
  core::Value out = core::Value::array();
  for (const core::RecordCount& r : tally.records()) out.push(core::reported(r));
  return out;
}

void add_records(core::Tally& tally, const core::Value& records) {
  for (const core::Value& r : records.items()) {
    const std::string& kind = r.find("name")->as_text();
    tally.read(kind, static_cast<std::uint64_t>(r.find("read")->as_int()));
    if (const core::Value* kept = r.find("kept")) tally.keep(kind, static_cast<std::uint64_t>(kept->as_int()));
  }
}

void expect_balance(const core::Tally& tally, const stages::Stage& stage) {
  if (const std::string kind = tally.unbalanced(); !kind.empty())
    throw core::Error(kind + " of its files were lost", std::string(stage.info().name), "this is a fault of the program");
}

bool is_survey_piece_done(const fs::path& folder) { return fs::exists(folder / record_name); }

SurveyPiece run_survey_piece(const stages::Stage& stage, stages::Context& context, const fs::path& folder, bool keep) {
  SurveyPiece piece;
  const stages::Records::Marks before = context.records.marks();
  const auto start = Clock::now();
  PieceRecord so_far;
  {
    const io::FinishedFiles watch([&](const fs::path& file) {
      const io::FinishedFiles apart;  // the record is not one of the stage's files
      so_far.files.push_back(piece_file(folder, file));
      write_record(folder / partial_name, so_far);
    });
    stage.run_survey(context, piece.tally, piece.findings);
    expect_balance(piece.tally, stage);
  }
  piece.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const bool kept = keep && write_handed_on(folder / handed_on_name, before, context);
  for (const PieceFile& f : so_far.files)
    if (!fs::exists(folder / f.name)) throw damaged_work(folder / f.name);
  std::error_code absent;
  fs::remove(folder / partial_name, absent);
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path() != folder / record_name) files.push_back(entry.path());
  piece.files = piece_files(folder, std::move(files));
  if (!kept) return piece;
  core::Value note = core::Value::object();
  note["tally"] = piece.tally.value();
  note["records"] = records_of(piece.tally);
  note["findings"] = piece.findings;
  note["seconds"] = piece.seconds;
  write_record(folder / record_name, {piece.files, std::move(note)});
  return piece;
}

SurveyPiece resume_survey_piece(stages::Context& context, const fs::path& folder) {
  std::optional<PieceRecord> record = read_record(folder / record_name);
  if (!record) throw damaged_work(folder / record_name);
  read_handed_on(folder / handed_on_name, context);
  const core::Value& note = record->note;
  core::Tally tally = core::Tally::from(*note.find("tally"));
  add_records(tally, *note.find("records"));
  return {std::move(tally), *note.find("findings"), note.find("seconds")->as_number(), std::move(record->files)};
}

}  // namespace swath::pipeline
