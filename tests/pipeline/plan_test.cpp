// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plan.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "core/parallel.h"
#include "io/las/las_writer.h"
#include "io/text/value_file.h"
#include "pipeline/describe.h"
#include "stages/registry.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

const char* good =
    "[[stage]]\ntype = \"readers.las\"\n"
    "[[stage]]\ntype = \"filters.smrf\"\nslope = 0.2\n"
    "[[stage]]\ntype = \"terrain.dtm\"\ncell = \"2 m\"\n";

struct Case {
  test::TemporaryFolder folder;
  Request request;
  explicit Case(const std::string& pipeline) {
    test::write_bytes(folder / "p.toml", pipeline);
    io::LasWriteOptions o;
    o.threads = 1;
    io::LasWriter cloud(folder / "cloud.las", o);
    cloud.finish();
    test::write_bytes(folder / "survey.toml", "crs = \"EPSG:32632\"\n[[points]]\nfile = \"cloud.las\"\ncrs = \"EPSG:32632\"\n");
    request.config = folder / "p.toml";
  }
  std::string fault() const {
    try {
      make_plan(request);
    } catch (const core::Error& e) {
      EXPECT_EQ(e.code(), core::Exit::bad_usage) << e.text();
      return e.text();
    }
    return "";
  }
};

TEST(Plan, ReadsConfigSurveyAndSets) {
  Case c(good);
  c.request.output = "elsewhere";
  c.request.sets = {"smrf.slope=0.3", "run.tile=250 m", "terrain.dtm.cell=\"50 cm\""};
  Plan plan = make_plan(c.request);
  ASSERT_EQ(plan.stages.size(), 4u);  // with quality.lines, which the terrain model of a cloud uses
  EXPECT_EQ(plan.run.tile.value, 250.0);
  const Explanation found = explain(plan);
  EXPECT_EQ(found.run.find("output")->find("value")->as_text(), "elsewhere");
  EXPECT_EQ(found.run.find("output")->find("from")->as_text(), "--output");
  EXPECT_EQ(found.run.find("tile")->find("from")->as_text(), "--set");
  EXPECT_EQ(found.run.find("threads")->find("from")->as_text(), "default");
  const core::Value& smrf = found.stages[1].options;
  EXPECT_EQ(smrf.find("slope")->find("value")->as_number(), 0.3);
  EXPECT_EQ(smrf.find("slope")->find("from")->as_text(), "--set");
  EXPECT_EQ(smrf.find("window")->find("from")->as_text(), "default");
  EXPECT_EQ(found.stages[3].options.find("cell")->find("value")->as_text(), "0.5 m");
}

TEST(Plan, ThreadsHaveTheLimitOfTheCommandLine) {
  Case c(good);
  c.request.sets = {"run.threads=1024"};
  EXPECT_EQ(make_plan(c.request).run.threads, core::max_threads);
  c.request.sets = {"run.threads=1025"};
  EXPECT_NE(c.fault().find("0 to 1024"), std::string::npos) << c.fault();
}

TEST(Plan, ATreeInPlaceOfAFileMayNameStagesOfItsOwn) {
  Case c("");
  c.request.tree = io::parse_toml(std::string(good) + "[[stage]]\ntype = \"a.copy\"\n", "the tree");
  const std::string unknown = c.fault();
  EXPECT_NE(unknown.find("'a.copy' is not a stage"), std::string::npos) << unknown;
  const auto line = std::count(good, good + std::strlen(good), '\n') + 2;
  EXPECT_NE(unknown.find("the tree:" + std::to_string(line) + ":"), std::string::npos) << unknown;
  c.request.entries = {{"a.copy", [] { return stages::make_stage("writers.las"); }}};
  c.request.config = "there is no such file";
  const Plan plan = make_plan(c.request);
  EXPECT_EQ(plan.stages.back().stage->info().name, "writers.las");
}

TEST(Plan, AStageThatAnotherUsesIsPutInFrontOfIt) {
  const auto names = [](const std::string& pipeline) {
    std::string out;
    for (const PlannedStage& s : make_plan(Case(pipeline).request).stages) out += std::string(s.stage->info().name) + " ";
    return out;
  };
  const auto stage = [](const std::string& type) { return "[[stage]]\ntype = \"" + type + "\"\n"; };
  EXPECT_EQ(names(stage("readers.las") + stage("filters.ground") + stage("terrain.dtm")),
            "readers.las quality.lines filters.ground terrain.dtm ");
  EXPECT_EQ(names(stage("readers.las") + stage("quality.lines") + stage("filters.noise") + stage("filters.ground")),
            "readers.las quality.lines filters.noise filters.ground ");
  EXPECT_EQ(names(stage("readers.las") + stage("terrain.dtm") + "assumed_sigma = \"5 cm\"\n"), "readers.las terrain.dtm ");
  // Points from raw records bring their sigmas.
  EXPECT_EQ(names(stage("readers.trajectory") + stage("readers.laser") + stage("georeference") + stage("terrain.dtm")),
            "readers.trajectory readers.laser georeference terrain.dtm ");
  EXPECT_EQ(Case(stage("filters.ground")).fault().find("quality.lines"), std::string::npos);  // nothing that was not asked for is a fault
}

TEST(Plan, TwoStagesThatMakeTheSameProductAreRefused) {
  const std::string writer = "[[stage]]\ntype = \"writers.las\"\n";
  EXPECT_NE(Case(good + writer + writer + "compress = false\n").fault().find("makes points in the output folder, as does stage[4]"),
            std::string::npos);
  EXPECT_EQ(Case(good + writer + writer + "folder = \"las\"\n").fault(), "");
  EXPECT_NE(Case(good + writer + "folder = \"./.swath/\"\n").fault(), "");
  EXPECT_NE(Case(good + writer + "folder = \"../elsewhere\"\n").fault(), "");
  EXPECT_NE(Case(good + writer + "folder = \"dtm/\"\n[[stage]]\ntype = \"writers.gdal\"\n").fault(), "");
}

TEST(Plan, RastersThatDoNotFitIntoTheMemoryAreRefused) {
  Case c(good);
  c.request.sets = {"smrf.cell=\"1 mm\""};
  std::string text = c.fault();
  for (const char* part : {"--set", "(filters.smrf).cell", "0.001 m", "run.memory = 2000 MB", "a larger cell, smaller tiles"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  c.request.sets = {"terrain.dtm.cell=\"1 cm\""};
  EXPECT_NE(c.fault().find("(terrain.dtm).cell"), std::string::npos) << c.fault();
  c.request.sets = {"terrain.dtm.cell=\"1 cm\"", "run.tile=\"10 m\"", "terrain.dtm.max_edge=\"3 m\"", "smrf.window=\"5 m\""};
  EXPECT_EQ(c.fault(), "");
  c.request.sets = {"smrf.window=\"100 km\""};
  text = c.fault();
  for (const char* part : {"(filters.smrf).window", "a smaller window, smaller tiles"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  // Of what is divided into cells none is so small that it gets by.
  const std::string noise = "[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"filters.noise\"\nlow_radius = \"1 mm\"\n";
  EXPECT_NE(Case(noise).fault().find("(filters.noise).low_radius"), std::string::npos);
}

TEST(Plan, OptionsThatMakeNoSenseAreNamed) {
  const std::string cloud = "[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"terrain.dtm\"\n";
  std::string text = Case(cloud + "[[stage]]\ntype = \"terrain.forest\"\ncell = \"1e9 m\"\n").fault();
  EXPECT_NE(text.find("\"1e9 m\" is out of range, allowed: > 0 m to 1000 m"), std::string::npos) << text;
  EXPECT_EQ(text.find("crown_cell"), std::string::npos) << text;
  text = Case(cloud + "[[stage]]\ntype = \"terrain.buildings\"\nmin_area = \"-10 m2\"\n").fault();
  EXPECT_NE(text.find("min_area must be an area of 0 or more"), std::string::npos) << text;
  Case c(cloud);
  test::write_bytes(c.folder / "survey.toml",
                    "[[points]]\nfile = \"cloud.las\"\ncrs = \"EPSG:32632\"\n[calibration]\nroll = \"4000 deg\"\n");
  c.request.survey = c.folder / "survey.toml";
  EXPECT_NE(c.fault().find("calibration.roll: \"4000 deg\" is out of range, allowed: -360 deg to 360 deg"), std::string::npos) << c.fault();
}

TEST(Plan, ACanopyNeedsItsModelsOnTheSameCells) {
  const std::string canopy = "[[stage]]\ntype = \"terrain.dsm\"\ncell = \"1 m\"\n[[stage]]\ntype = \"terrain.canopy\"\n";
  const std::string text = Case(good + canopy).fault();
  for (const char* part : {"terrain.canopy", "2 m of dtm", "1 m of dsm"}) EXPECT_NE(text.find(part), std::string::npos) << text;
  Case c(good + canopy);
  c.request.sets = {"terrain.dsm.cell=\"2 m\""};
  EXPECT_EQ(c.fault(), "");
}

TEST(Plan, TellsWhereAValueCameFrom) {
  Case c(good);
  Plan plan = make_plan(c.request);
  EXPECT_TRUE(explain(plan).stages[1].options.find("slope")->find("from")->as_text().ends_with("p.toml:5:9"));
}

TEST(Plan, AllFaultsAtOnceWithTheirPlaces) {
  const Case c(
      "[[stage]]\ntype = \"readers.las\"\n"
      "[[stage]]\ntype = \"filters.smfr\"\n"
      "[[stage]]\ntype = \"filters.smrf\"\nslop = 0.2\ncell = 1.0\n"
      "[[stage]]\ntype = \"terrain.dtm\"\ncell = \"2 deg\"\n[rnu]\ntile = 1\n");
  const std::string text = c.fault();
  for (const char* part :
       {"p.toml:4:", "did you mean 'filters.smrf'", "did you mean 'slope'", "no unit", "'deg' is not a unit of length", "rnu"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
}

TEST(Plan, StagesMustFitOneAnother) {
  EXPECT_NE(Case("[[stage]]\ntype = \"readers.las\"\n[[stage]]\ntype = \"terrain.contours\"\n").fault().find("needs dtm"),
            std::string::npos);
  EXPECT_NE(Case("[[stage]]\ntype = \"georeference\"\n").fault().find("needs shots"), std::string::npos);
  EXPECT_NE(Case("[[stage]]\ntype = \"filters.smrf\"\n").fault().find("no reader"), std::string::npos);
  EXPECT_NE(Case("").fault().find("no stages"), std::string::npos);
  EXPECT_NE(Case(std::string(good) + "[[stage]]\ntype = \"filters.returns\"\n").fault().find("strip stage behind a tile stage"),
            std::string::npos);
}

TEST(Plan, SurveyStagesAloneNeedNoSourceAndNoMap) {
  const std::string trajectory = "[[stage]]\ntype = \"readers.trajectory\"\n";
  Case c(trajectory);
  test::write_bytes(c.folder / "t.csv", "not read by check");
  const std::string survey =
      "[[points]]\nfile = \"cloud.las\"\n[[trajectory]]\nfile = \"t.csv\"\ntime.scale = \"gps\"\nangle_unit = \"deg\"\n"
      "columns = {time = \"1\", latitude = \"2\", longitude = \"3\", height = \"4\", roll = \"5\", pitch = \"6\", heading = \"7\"}\n";
  test::write_bytes(c.folder / "survey.toml", "crs = \"EPSG:4326\"\n" + survey);
  c.request.survey = c.folder / "survey.toml";
  EXPECT_EQ(c.fault(), "");
  EXPECT_FALSE(works_on_the_map(make_plan(c.request)));
  // As soon as a stage works on the map both are needed.
  test::write_bytes(c.folder / "p.toml", trajectory + "[[stage]]\ntype = \"filters.smrf\"\n");
  EXPECT_NE(c.fault().find("no reader"), std::string::npos);
  test::write_bytes(c.folder / "p.toml", trajectory + good);
  EXPECT_NE(c.fault().find("not a map projection"), std::string::npos);
}

TEST(Plan, AMapOfSouthingsIsRefused) {
  Case c(good);
  c.request.survey = c.folder / "survey.toml";
  const std::string cloud = "[[points]]\nfile = \"cloud.las\"\ncrs = \"EPSG:5513\"\n";
  for (const std::string& survey : {"crs = \"EPSG:5513\"\n" + cloud, cloud}) {
    test::write_bytes(c.folder / "survey.toml", survey);
    EXPECT_NE(c.fault().find("southing and westing"), std::string::npos) << c.fault();
    EXPECT_NE(c.fault().find("EPSG:5514"), std::string::npos) << c.fault();
  }
  test::write_bytes(c.folder / "survey.toml", "crs = \"EPSG:5514\"\n" + cloud);
  EXPECT_EQ(c.fault(), "");
}

TEST(Plan, TheLongestNameOfAStageIsMeant) {
  Case c(std::string(good) + "[[stage]]\ntype = \"quality.swath\"\n[[stage]]\ntype = \"report.quality\"\n");
  c.request.sets = {"quality.swath.anps=5m", "quality.limits.nva=\"1 m\""};
  EXPECT_EQ(c.fault().find("unknown key"), std::string::npos) << c.fault();
}

TEST(Plan, ASetThatFitsNothingIsAFault) {
  Case c(good);
  c.request.sets = {"smfr.slope=1"};
  EXPECT_NE(c.fault().find("no stage 'smfr'"), std::string::npos);
  c.request.sets = {"slope"};
  EXPECT_NE(c.fault().find("is not stage.key=value"), std::string::npos);
  std::string deep = "smrf";
  for (int i = 0; i < 50000; ++i) deep += ".a";
  c.request.sets = {deep + "=1"};
  EXPECT_THROW(make_plan(c.request), core::Error);
  c.request.sets = {"smrf.slope=steep"};
  EXPECT_NE(c.fault().find("--set"), std::string::npos);
}

TEST(Plan, TheSameTreeAsJson) {
  Case c(good);
  test::write_bytes(c.folder / "p.json", io::to_json(io::read_value_file(c.folder / "p.toml")));
  Plan toml = make_plan(c.request);
  c.request.config = c.folder / "p.json";
  Plan json = make_plan(c.request);
  for (size_t i = 0; i < toml.stages.size(); ++i)
    EXPECT_EQ(core::fingerprint_of(toml.stages[i].describe()), core::fingerprint_of(json.stages[i].describe()));
}

TEST(Plan, SchemaNamesEveryStage) {
  const std::string text = io::to_json(schema());
  for (const char* part : {"filters.smrf", "readers.laser", "writers.las", "lever_arm_scanner", "additionalProperties"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace swath::pipeline
