// SPDX-License-Identifier: GPL-3.0-or-later
// The whole chain on a small simulated survey: products, counts, errors against truth, independence of threads and tiling.
#include "pipeline/run.h"

#include <algorithm>
#include <map>

#include "core/config/option_visitors.h"
#include "io/text/value_file.h"
#include "pipeline/work/store_file.h"
#include "simulate/simulate.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

/// One survey for all tests of this file.
const fs::path& survey_folder() {
  static const test::TemporaryFolder folder;
  static const bool made = [] {
    simulate::Options o = simulate::preset(simulate::Scene::hills);
    o.mounting.deliver = simulate::Deliver::truth;
    simulate::run(o, folder.path());
    return true;
  }();
  static_cast<void>(made);
  return folder.path();
}

Request request(const fs::path& output, std::vector<std::string> sets = {}) {
  Request r;
  r.config = test::source_folder() / "configs/survey_sbet.toml";
  r.survey = survey_folder() / "survey.toml";
  r.output = output;
  r.sets = std::move(sets);
  r.threads = 2;
  return r;
}

core::Value run_quietly(const Request& r) {
  Plan plan = make_plan(r);
  Progress progress(Voice::quiet);
  return run(plan, progress, "test").report;
}

const core::Value& stage_of(const core::Value& report, const std::string& type) {
  for (const core::Value& s : report.find("stages")->items())
    if (s.find("type")->as_text() == type) return s;
  throw std::runtime_error("no stage " + type);
}

/// Every product's bytes by name; the report tells of times and is left out.
std::map<std::string, std::string> products(const fs::path& folder) {
  std::map<std::string, std::string> out;
  for (const auto& e : fs::recursive_directory_iterator(folder))
    if (e.is_regular_file() && e.path().filename() != "report.json")
      out[fs::relative(e.path(), folder).string()] = test::read_bytes(e.path());
  return out;
}

TEST(Run, MakesEveryProductAndTellsItsErrors) {
  const test::TemporaryFolder out;
  const core::Value report = run_quietly(request(out / "out"));
  for (const char* product : {"report.json", "relief.png", "dtm.vrt", "dsm.vrt", "contours.gpkg", "contours.dxf", "contours.geojson",
                              "penetration.vrt", "points"})
    EXPECT_TRUE(fs::exists(out / "out" / product)) << product;
  EXPECT_FALSE(fs::exists(out / "out/.swath"));
  const core::Value& truth = *stage_of(report, "report.truth").find("findings");
  // Range noise 1.5 cm, angles 0.001 deg at 350 m, trajectory 2-3 cm: what the survey's own sigmas add up to.
  EXPECT_LT(truth.find("rms_3d")->as_number(), 0.10);
  EXPECT_GT(truth.find("rms_3d")->as_number(), 0.005);
  EXPECT_LT(std::abs(truth.find("dtm")->find("mean_m")->as_number()), 0.10);
  EXPECT_LT(truth.find("dtm")->find("median_abs_m")->as_number(), 0.10);
  for (const core::Value& s : report.find("stages")->items())
    if (const core::Value* counts = s.find("counts")) {
      EXPECT_EQ(counts->find("in")->as_int(), counts->find("out")->as_int())
          << s.find("type")->as_text() << ": nothing is left out in this survey";
    }
}

TEST(Run, ThreadsChangeNothing) {
  const test::TemporaryFolder out;
  run_quietly(request(out / "two"));
  Request one = request(out / "one");
  one.threads = 1;
  run_quietly(one);
  EXPECT_EQ(products(out / "one"), products(out / "two"));
}

TEST(Run, TheTilingChangesNoContourAndNoPicture) {
  const test::TemporaryFolder out;
  run_quietly(request(out / "a", {"run.tile=250 m"}));
  run_quietly(request(out / "b", {"run.tile=120 m"}));
  const auto a = products(out / "a"), b = products(out / "b");
  for (const char* name : {"contours.geojson", "contours.dxf", "contours.gpkg", "relief.png"}) EXPECT_EQ(a.at(name), b.at(name)) << name;
}

TEST(Run, KeptWorkIsNotDoneAgainAndChangedLateStagesAlone) {
  const test::TemporaryFolder out;
  run_quietly(request(out / "out", {"run.keep_work=true"}));
  const auto first = products(out / "out");
  const core::Value again = run_quietly(request(out / "out", {"run.keep_work=true"}));
  EXPECT_GT(again.find("pieces_resumed")->as_int(), 5);
  EXPECT_EQ(products(out / "out").size(), first.size());
  const core::Value changed = run_quietly(request(out / "out", {"run.keep_work=true", "contours.interval=2 m"}));
  EXPECT_GT(changed.find("pieces_resumed")->as_int(), 2);
  EXPECT_LT(changed.find("pieces_resumed")->as_int(), again.find("pieces_resumed")->as_int());
}

TEST(Run, KeptStripsServeAPlanWithOtherStagesBehindThem) {
  const test::TemporaryFolder out;
  const std::string strips =
      "[[stage]]\ntype = \"readers.trajectory\"\n[[stage]]\ntype = \"readers.laser\"\n"
      "[[stage]]\ntype = \"georeference\"\n";
  const std::string noise = "[[stage]]\ntype = \"filters.noise\"\n", las = "[[stage]]\ntype = \"writers.las\"\n";
  Request r = request(out / "out", {"run.keep_work=true"});
  r.config = out / "p.toml";
  std::int64_t resumed = 0;
  for (const std::string& stages : {strips + las, strips + noise + las, strips + las}) {
    test::write_bytes(r.config, stages);
    const core::Value report = run_quietly(r);
    EXPECT_EQ(stage_of(report, "georeference").find("counts")->find("out")->as_int(),
              stage_of(report, "writers.las").find("counts")->find("in")->as_int());
    resumed = report.find("pieces_resumed")->as_int();
  }
  EXPECT_GE(resumed, 2);  // the flight lines
}

const std::string terrain_stages =
    "[[stage]]\ntype = \"readers.trajectory\"\n[[stage]]\ntype = \"readers.laser\"\n[[stage]]\ntype = \"georeference\"\n"
    "[[stage]]\ntype = \"filters.ground\"\n[[stage]]\ntype = \"terrain.dtm\"\n[[stage]]\ntype = \"writers.gdal\"\n";

TEST(Run, StripsKeptOnceServeARunThatDoesNotKeepItsWork) {
  const test::TemporaryFolder out;
  const auto changed = [&](const std::string& name, std::vector<std::string> sets) {
    Request r = request(out / name, std::move(sets));
    r.config = out / "p.toml";
    r.sets.push_back("terrain.dtm.cell=1 m");
    return r;
  };
  const auto second_of = [&](const std::string& name, const std::vector<std::string>& sets) {
    Request first = changed(name, {"run.keep_work=true"});
    first.sets.back() = "terrain.dtm.cell=2 m";
    run_quietly(first);
    return run_quietly(changed(name, sets)).find("pieces_resumed")->as_int();
  };
  test::write_bytes(out / "p.toml", terrain_stages);
  const std::int64_t kept_again = second_of("kept", {"run.keep_work=true"});
  EXPECT_GE(kept_again, 2);  // the flight lines
  EXPECT_EQ(second_of("once", {}), kept_again);
  EXPECT_FALSE(fs::exists(out / "once/.swath"));
  run_quietly(changed("fresh", {}));
  const auto once = products(out / "once"), fresh = products(out / "fresh");
  EXPECT_TRUE(fresh.contains("dtm.vrt"));
  for (const auto& [name, bytes] : fresh) EXPECT_TRUE(once.contains(name) && once.at(name) == bytes) << name;
}

/// The columns of the points that lie in the work folder's strips.
core::ColumnSet columns_of_strips(const fs::path& work) {
  core::ColumnSet out;
  for (const auto& e : fs::recursive_directory_iterator(work)) {
    if (e.path().extension() != ".pts") continue;
    StoreFile file(e.path(), StoreFile::Mode::read);
    ChunkHead head;
    if (file.next(head)) out = out | head.set();
  }
  return out;
}

TEST(Run, ColumnsThatOnlyWritersReadAreNotKeptForATerrainModelAlone) {
  const test::TemporaryFolder out;
  Request r = request(out / "out");
  r.config = out / "p.toml";
  // A late failure leaves the work.
  test::write_bytes(r.config, terrain_stages + "[[stage]]\ntype = \"writers.picture\"\ncontours = \"dtm.vrt\"\n");
  EXPECT_THROW(run_quietly(r), core::Error);
  const core::ColumnSet kept = columns_of_strips(out / "out/.swath");
  EXPECT_TRUE(kept.contains({core::Column::x, core::Column::y, core::Column::z, core::Column::record}));
  for (const core::Column c : {core::Column::intensity, core::Column::scan_angle}) EXPECT_FALSE(kept.has(c)) << static_cast<int>(c);
  // A plan that writes the points as well gets all their columns.
  test::write_bytes(r.config, terrain_stages + "[[stage]]\ntype = \"writers.las\"\n");
  run_quietly(r);
  Request fresh = r;
  fresh.output = out / "fresh";
  run_quietly(fresh);
  EXPECT_TRUE(fs::exists(out / "fresh/points"));
  EXPECT_EQ(products(out / "out"), products(out / "fresh"));
}

TEST(Run, TilesOfAnEarlierTilingGo) {
  const test::TemporaryFolder out;
  run_quietly(request(out / "out", {"run.tile=120 m"}));
  run_quietly(request(out / "out", {"run.tile=250 m"}));
  run_quietly(request(out / "fresh", {"run.tile=250 m"}));
  EXPECT_EQ(products(out / "out"), products(out / "fresh"));
}

TEST(Run, AMissedLimitEndsWithCode3) {
  const test::TemporaryFolder out;
  Plan plan = make_plan(request(out / "out", {"run.limits.truth_rms=1 mm"}));
  Progress progress(Voice::quiet);
  EXPECT_EQ(run(plan, progress, "test").code, core::Exit::quality_missed);
}

TEST(Run, BadDataLeavesNothingBehind) {
  const test::TemporaryFolder out;
  fs::copy(survey_folder(), out / "survey", fs::copy_options::recursive);
  const std::string bytes = test::read_bytes(out / "survey/laser.npy");
  test::write_bytes(out / "survey/laser.npy", bytes.substr(0, bytes.size() / 2));
  Request r = request(out / "out");
  r.survey = out / "survey/survey.toml";
  EXPECT_THROW(run_quietly(r), core::Error);
  EXPECT_FALSE(fs::exists(out / "out"));
}

TEST(Run, SurveyStagesAloneRunWithoutAMap) {
  const test::TemporaryFolder out;
  test::write_bytes(out / "p.toml", "[[stage]]\ntype = \"readers.trajectory\"\n");
  Request r = request(out / "out");
  r.config = out / "p.toml";
  const core::Value report = run_quietly(r);
  const core::Value& stage = stage_of(report, "readers.trajectory");
  EXPECT_GT(stage.find("findings")->find("records")->as_int(), 1000);
  EXPECT_EQ(stage.find("counts"), nullptr);
  EXPECT_TRUE(fs::exists(out / "out/report.json"));
  EXPECT_FALSE(fs::exists(out / "out/.swath"));
}

TEST(Run, APlanWithoutSurveyIsNotRun) {
  const test::TemporaryFolder out;
  Request r = request(out / "out");
  r.survey.clear();
  Plan plan = make_plan(r);
  Progress progress(Voice::quiet);
  EXPECT_THROW(run(plan, progress, "test"), core::Error);
}

}  // namespace
}  // namespace swath::pipeline
