// SPDX-License-Identifier: GPL-3.0-or-later
// What a stage needs and gives is read from its function's signature.
#include "stages/once.h"

#include <gtest/gtest.h>

#include "stages/tile_filter.h"

namespace swath::stages {
namespace {

struct ShiftOptions {
  int by = 2;
};
template <class V>
void describe(ShiftOptions& o, V& v) {
  v.option("by", o.by, "Seconds that are added.");
}

struct ShiftFindings {
  std::uint64_t fixes = 0;
  bool has_events = false;
};
template <class V>
void describe(const ShiftFindings& r, V& v) {
  v.result("fixes", r.fixes, "Fixes.");
  v.result("has_events", r.has_events, "Is there an event?");
}

/// Takes the IMU records and gives fixes of their times.
Given<core::GnssData, ShiftFindings> shifted(core::ImuData imu, const ShiftOptions& o, const core::EventData* events, const Output& to,
                                             core::Tally& tally) {
  core::GnssData out;
  for (const double t : imu.time) out.time.push_back(t + o.by);
  tally.count(to.folder.string());
  return {std::move(out), {imu.time.size(), events != nullptr}};
}

std::unique_ptr<Stage> shift_stage() { return once<shifted>("test.shift", "Shifts.").make(); }

TEST(Once, NeedsAndGivesAreTheSignature) {
  const auto stage = shift_stage();
  const Info& info = stage->info();
  EXPECT_EQ(info.needs_products, (std::vector<Product>{Product::of<core::ImuData>()}));
  EXPECT_EQ(info.uses_products, (std::vector<Product>{Product::of<core::EventData>()}));
  EXPECT_EQ(info.gives_products, (std::vector<Product>{Product::of<core::GnssData>()}));
  EXPECT_TRUE(info.uses(Product::of<core::EventData>()));
  EXPECT_FALSE(info.takes(Product::of<core::EventData>()));
  const auto docs = core::document_results([&](core::ResultVisitor& v) { stage->visit_findings(v); });
  ASSERT_EQ(docs.size(), 2u);
  EXPECT_EQ(docs[0].path, "fixes");
}

TEST(Once, ARecordIsMovedOnItsLastUseAndCopiedBeforeIt) {
  const io::Survey survey;
  Context context{survey};
  context.output = "folder";
  const auto stage = shift_stage();
  core::ImuData imu;
  imu.time = {1.0, 2.0};
  context.records.put(imu);
  const double* place = context.records.get<core::ImuData>().time.data();
  core::Tally tally;
  core::Value findings;
  stage->run_survey(context, tally, findings);
  ASSERT_TRUE(context.records.has<core::ImuData>());
  EXPECT_EQ(context.records.get<core::ImuData>().time.data(), place);
  EXPECT_EQ(context.records.get<core::GnssData>().time, (std::vector<double>{3.0, 4.0}));
  EXPECT_EQ(findings.find("fixes")->as_int(), 2);
  EXPECT_FALSE(findings.find("has_events")->as_bool());
  EXPECT_EQ(tally.of("folder"), 1u);

  context.records.put(core::EventData());
  context.last_uses = {Product::of<core::ImuData>()};
  stage->run_survey(context, tally, findings);
  EXPECT_FALSE(context.records.has<core::ImuData>());
  EXPECT_TRUE(findings.find("has_events")->as_bool());
}

Corrected<core::EventData, ShiftFindings> corrected(const core::EventData& events, const ShiftOptions& o) {
  if (o.by == 0) return {std::nullopt, {}};
  core::EventData out = events;
  for (double& t : out.time) t += o.by;
  return {std::move(out), {1, true}};
}

TEST(Once, ARecordIsCorrectedOrStays) {
  const io::Survey survey;
  Context context{survey};
  const auto stage = once<corrected>("test.correct", "Corrects.").make();
  EXPECT_EQ(stage->info().gives_products, (std::vector<Product>{Product::of<core::EventData>()}));
  core::EventData events;
  events.time = {1.0};
  context.records.put(events);
  const core::EventData* before = &context.records.get<core::EventData>();
  core::Tally tally;
  core::Value findings;
  auto& options = dynamic_cast<OnceStage<corrected>&>(*stage).options;
  options.by = 0;
  stage->run_survey(context, tally, findings);
  EXPECT_EQ(&context.records.get<core::EventData>(), before);
  EXPECT_EQ(findings.find("fixes")->as_int(), 0);
  options.by = 2;
  stage->run_survey(context, tally, findings);
  EXPECT_EQ(context.records.get<core::EventData>().time, (std::vector<double>{3.0}));
  EXPECT_EQ(findings.find("fixes")->as_int(), 1);
}

TEST(Once, TakingTheLastUseMovesTheRecord) {
  Records records;
  core::ImuData imu;
  imu.time = {1.0, 2.0};
  records.put(imu);
  const double* place = records.get<core::ImuData>().time.data();
  const core::ImuData copy = records.take<core::ImuData>(false);
  EXPECT_NE(copy.time.data(), place);
  const core::ImuData moved = records.take<core::ImuData>(true);
  EXPECT_EQ(moved.time.data(), place);
  EXPECT_THROW(records.get<core::ImuData>(), core::Error);
}

TEST(Once, ACopyOfTheStoreKeepsItsRecord) {
  Records records;
  core::EventData events;
  events.time = {1.0};
  records.put(events);
  const Records copy = records;
  const Records::Marks before = records.marks();
  EXPECT_EQ(records.take<core::EventData>(true).time.size(), 1u);
  EXPECT_EQ(copy.get<core::EventData>().time.size(), 1u);
  EXPECT_NE(Records::mark_of<core::EventData>(before), 0u);
  EXPECT_EQ(Records::mark_of<core::EventData>(records.marks()), 0u);
}

TEST(Once, ARecordThatIsNotDeclaredIsAFaultOfTheProgram) {
  const io::Survey survey;
  Context context{survey};
  context.records.put(core::EventData());
  const auto stage = shift_stage();
  EXPECT_NE(stage->record<core::EventData>(context), nullptr);
  EXPECT_EQ(stage->record<core::ImuData>(context), nullptr);
  EXPECT_THROW(stage->record<core::GnssData>(context), core::Error) << "given, but neither needed nor used";
}

struct MarkCounts {
  core::Flagged marked;
};
template <class V>
void describe(const MarkCounts& r, V& v) {
  v.result("marked", r.marked, "Marked points.");
}
core::TileColumns columns(const ShiftOptions& o) {
  using core::Column;
  return {.needs = {Column::flags}, .reads = o.by > 5 ? core::ColumnSet{Column::range} : core::ColumnSet{}, .gives = {Column::flags}};
}
MarkCounts mark(core::Block& block, size_t own, const ShiftOptions& o) {
  MarkCounts n;
  for (size_t i = 0; i < own; ++i) block.flags[i] = static_cast<std::uint16_t>(o.by), ++n.marked;
  return n;
}

TEST(TileFilter, AFunctionWithColumnsIsAStage) {
  const auto stage = filter<mark>("test.mark", "Marks.").make();
  EXPECT_EQ(stage->info().needs, core::ColumnSet{core::Column::flags});
  EXPECT_EQ(stage->info().gives, core::ColumnSet{core::Column::flags});
  EXPECT_EQ(stage->halo(), 0.0);
  EXPECT_TRUE(stage->also_reads().empty());
  dynamic_cast<TileFilter<mark>&>(*stage).options.by = 6;
  EXPECT_TRUE(stage->also_reads().has(core::Column::range));
  const io::Survey survey;
  TileJob job;
  job.block.x = job.block.y = job.block.z = {1, 2, 3};
  job.block.flags.resize(3);
  job.own = 2;
  stage->run_tile(Context{survey}, job);
  EXPECT_EQ(job.tally.of("marked"), 2u);
  EXPECT_EQ(job.block.flags[2], 0);
}

}  // namespace
}  // namespace swath::stages
