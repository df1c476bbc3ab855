// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/survey_piece.h"

#include <optional>

#include "core/error.h"
#include "io/text/output_file.h"
#include "pipeline/work/work_folder.h"
#include "stages/once.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

/// Hands on fixes, makes two files and fails before the second with `fails`.
class Solver : public stages::Stage {
 public:
  explicit Solver(bool fails = false) : fails_(fails) {}
  const stages::Info& info() const override {
    static const stages::Info info{"gnss.solver", "", {stages::Grain::survey}, {}, {}, {}, {stages::Product::of<core::GnssData>()}};
    return info;
  }
  void visit(core::Visitor&) override {}
  void run_survey(stages::Context& context, core::Tally& tally, core::Value& findings) const override {
    io::write_text_file(context.output / "base_1.pos", "of hours");
    if (fails_) throw core::SystemError("killed");
    io::write_text_file(context.output / "base_2.pos", "of hours too");
    core::GnssData gnss;
    gnss.time = {1.0, 2.0};
    context.records.put(std::move(gnss));
    tally.count("fixes", 2);
    findings["rate_hz"] = 1.0;
  }

 private:
  bool fails_;
};

class Survey : public ::testing::Test {
 protected:
  stages::Context context() const {
    stages::Context c{survey_};
    c.output = stage_ / "products";
    return c;
  }
  io::Survey survey_;
  test::TemporaryFolder folder_;
  fs::path work_ = folder_ / ".swath", stage_ = work_ / "00-gnss.solver-0123456789abcdef";
};

TEST_F(Survey, IsTakenUpWithWhatItHandedOn) {
  stages::Context first = context(), again = context();
  EXPECT_FALSE(is_survey_piece_done(stage_));
  const SurveyPiece made = run_survey_piece(Solver(), first, stage_);
  ASSERT_TRUE(is_survey_piece_done(stage_));
  EXPECT_EQ(keep_whole_work(work_).pieces, 1u);
  const SurveyPiece back = resume_survey_piece(again, stage_);
  EXPECT_EQ(again.records.get<core::GnssData>().time, first.records.get<core::GnssData>().time);
  EXPECT_EQ(back.tally.of("fixes"), 2u);
  EXPECT_EQ(back.findings.find("rate_hz")->as_number(), 1.0);
  EXPECT_EQ(back.files.size(), made.files.size());
  EXPECT_EQ(back.files.size(), 3u) << "two products, and what is handed on";
}

const double* taken = nullptr;  // where the fixes lay that came()
core::EventData came(core::GnssData gnss) {
  taken = gnss.time.data();
  core::EventData out;
  out.time = gnss.time;
  return out;
}

TEST_F(Survey, AStageThatUsesARecordUpTakesItAndIsNotDoneAgain) {
  stages::Context first = context(), again = context();
  for (stages::Context* c : {&first, &again}) {
    core::GnssData gnss;
    gnss.time = {1.0, 2.0};
    c->records.put(std::move(gnss));
    c->last_uses = {stages::Product::of<core::GnssData>()};
  }
  const double* place = first.records.get<core::GnssData>().time.data();
  run_survey_piece(*stages::once<came>("test.came", "").make(), first, stage_);
  EXPECT_EQ(taken, place) << "moved, not copied";
  EXPECT_FALSE(first.records.has<core::GnssData>());
  ASSERT_TRUE(is_survey_piece_done(stage_));
  resume_survey_piece(again, stage_);
  EXPECT_FALSE(again.records.has<core::GnssData>());
  EXPECT_EQ(again.records.get<core::EventData>().time, (std::vector<double>{1.0, 2.0}));
}

/// Makes a product and another file, which it removes: one of its own, or one that it counts as made.
class Trier : public Solver {
 public:
  explicit Trier(bool apart) : apart_(apart) {}
  void run_survey(stages::Context& context, core::Tally& tally, core::Value& findings) const override {
    const fs::path trial = context.output / "trial.pos";
    std::optional<io::FinishedFiles> own;
    if (apart_) own.emplace();
    io::write_text_file(trial, "of seconds");
    own.reset();
    fs::remove(trial);
    Solver::run_survey(context, tally, findings);
  }

 private:
  bool apart_;
};

TEST_F(Survey, AFileThatGoesMeanwhileIsSeenUnlessItIsTheStagesOwn) {
  stages::Context c = context();
  EXPECT_EQ(run_survey_piece(Trier(true), c, stage_).files.size(), 3u);
  fs::remove_all(stage_);
  stages::Context again = context();
  EXPECT_THROW(run_survey_piece(Trier(false), again, stage_), core::SystemError);
  EXPECT_FALSE(is_survey_piece_done(stage_));
}

TEST_F(Survey, WhatWasFinishedBeforeAKillIsKeptWhereItIsWhole) {
  stages::Context c = context();
  EXPECT_THROW(run_survey_piece(Solver(true), c, stage_), core::SystemError);
  EXPECT_FALSE(is_survey_piece_done(stage_));
  keep_whole_work(work_);
  EXPECT_EQ(test::read_bytes(stage_ / "products/base_1.pos"), "of hours");
  test::write_bytes(stage_ / "products/base_1.pos", "Of hours");
  EXPECT_EQ(keep_whole_work(work_).damaged, 1u);
  EXPECT_FALSE(fs::exists(stage_ / "products/base_1.pos"));
}

TEST_F(Survey, IsNotDoneWhereAFileOfItIsDamaged) {
  stages::Context c = context();
  run_survey_piece(Solver(), c, stage_);
  test::write_bytes(stage_ / "handed_on.bin", test::read_bytes(stage_ / "handed_on.bin") + "x");
  keep_whole_work(work_);
  EXPECT_FALSE(is_survey_piece_done(stage_));
}

}  // namespace
}  // namespace swath::pipeline
