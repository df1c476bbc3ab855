// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/pdal_pipeline.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/geo/crs.h"
#include "io/las/las_crs.h"
#include "io/text/value_file.h"
#include "pipeline/plan.h"
#include "tests/io/copc/copc_sample.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Value;

/// A folder with a cloud in metres and one in feet, worked in.
class Pdal : public ::testing::Test {
 protected:
  Pdal() : before_(fs::current_path()) {
    fs::current_path(folder_.path());
    for (const auto& [name, crs] : {std::pair{"metres.laz", "EPSG:32632"}, {"feet.laz", "EPSG:2992"}}) {
      io::LasHeader header = test::sample_header(6);
      io::add_las_wkt(header, core::Crs(crs).wkt1());
      test::write_sample(name, header, test::sample_points(header, 100), 1);
    }
  }
  ~Pdal() override { fs::current_path(before_); }

  static PdalPipeline read(const std::string& json) {
    const Value tree = io::parse_json(json, "x.json");
    EXPECT_TRUE(is_pdal_pipeline(tree));
    return read_pdal_pipeline(tree, "x.json");
  }
  static Value config(const std::string& json) { return std::get<0>(read(json)); }
  static std::string fault_of(const std::string& json) {
    try {
      read(json);
    } catch (const core::Error& e) {
      EXPECT_EQ(e.code(), core::Exit::bad_usage);
      EXPECT_NE(e.where().find("x.json"), std::string::npos) << e.text();
      return e.text();
    }
    return "";
  }
  /// A pipeline from metres.laz, its stages between reader and writer.
  static std::string chain(const std::string& stages, const std::string& writer = "\"out/p.laz\"",
                           const std::string& reader = "\"metres.laz\"") {
    return "{\"pipeline\": [" + reader + (stages.empty() ? "" : ", " + stages) + ", " + writer + "]}";
  }

  fs::path before_;
  test::TemporaryFolder folder_;
};

const std::string ground = R"({"type": "filters.range", "limits": "Classification[2:2]"})";

TEST_F(Pdal, GroundAndTerrainModel) {
  const Value c = config(chain(R"({"type": "filters.smrf", "cell": 2.0, "slope": "0.2", "returns": "last, only"}, )" + ground,
                               R"({"type": "writers.gdal", "filename": "out/dtm.tif", "resolution": 0.5, "output_type": "idw"})"));
  EXPECT_EQ(io::to_json(*c.find("stage")), io::to_json(io::parse_json(R"([{"type": "readers.las"},
              {"type": "filters.smrf", "cell": "2 m", "window": "18 m", "threshold": "0.5 m", "scalar": 1.25, "slope": 0.2},
              {"type": "terrain.dtm", "cell": "0.5 m", "classes": [2]}, {"type": "writers.gdal"}])",
                                                                      "made")));
  EXPECT_EQ(c.find("run")->find("output")->as_text(), "out/dtm");
}

TEST_F(Pdal, NoiseThatAGroundFilterIsToIgnoreIsIgnoredAnyway) {
  const auto [c, survey, runs_as] = read(chain(R"({"type": "filters.smrf", "ignore": "Classification[7:7]"})"));
  EXPECT_EQ(c.find("stage")->items()[1].find("ignore"), nullptr);
  EXPECT_NE(runs_as[1].find("noise (7, 18) and withheld points left out"), std::string::npos) << runs_as[1];
}

TEST_F(Pdal, LengthsAreInUnitsOfTheCrs) {
  const Value c = config(chain(R"({"type": "filters.smrf", "cell": 10})", "\"p.laz\"", "\"feet.laz\""));
  const Value& smrf = c.find("stage")->items()[1];
  EXPECT_EQ(smrf.find("cell")->as_text(), "3.048 m");
  EXPECT_EQ(smrf.find("threshold")->as_text(), "0.1524 m");
  EXPECT_NEAR(smrf.find("scalar")->as_number(), 1.25 * 0.3048, 1e-12);
  EXPECT_EQ(smrf.find("slope"), nullptr) << "the default of both";
}

TEST_F(Pdal, OutliersByRadiusAreIsolatedPoints) {
  const auto outliers = [](const std::string& options, const std::string& reader) {
    return io::to_json(
        config(chain(R"({"type": "filters.outlier", "method": "radius")" + options + "}", "\"p.laz\"", reader)).find("stage")->items()[1]);
  };
  const auto noise = [](const std::string& json) { return io::to_json(io::parse_json(json, "made")); };
  EXPECT_EQ(outliers("", "\"metres.laz\""),
            noise(R"({"type": "filters.noise", "radius": "1 m", "neighbours": 2, "widen": false, "low_group": 0})"));
  EXPECT_EQ(outliers(R"(, "radius": 10, "min_k": "4")", "\"feet.laz\""),
            noise(R"({"type": "filters.noise", "radius": "3.048 m", "neighbours": 4, "widen": false, "low_group": 0})"));
  const Value statistical = config(chain(R"({"type": "filters.outlier", "method": "statistical", "mean_k": 6})"));
  EXPECT_EQ(statistical.find("stage")->items()[1].find("type")->as_text(), "filters.outlier");
}

TEST_F(Pdal, TheCrsOfAReaderIsThatOfItsFileAlone) {
  io::LasHeader bare = test::sample_header(6);
  test::write_sample("bare.laz", bare, test::sample_points(bare, 100), 1);
  const auto crs_of = [](const std::string& json) {
    const Value survey = std::get<1>(read(json));
    std::vector<std::string> out;
    for (const Value& cloud : survey.find("points")->items()) out.push_back(cloud.find("crs") ? cloud.find("crs")->as_text() : "");
    return out;
  };
  using Texts = std::vector<std::string>;
  const std::string to_utm = R"({"type": "filters.reprojection", "out_srs": "EPSG:32610"}, "p.laz"])";
  EXPECT_EQ(crs_of(R"([{"type": "readers.las", "filename": "feet.laz", "override_srs": "EPSG:2994"}, "metres.laz",
                       {"type": "readers.las", "filename": "bare.laz", "override_srs": "EPSG:32633"}, )" +
                   to_utm),
            (Texts{"EPSG:2994", "", "EPSG:32633"}));
  // default_srs is for files that state none.
  EXPECT_EQ(crs_of(R"([{"type": "readers.las", "filename": "feet.laz", "default_srs": "EPSG:32633"},
                       {"type": "readers.las", "filename": "bare.laz", "default_srs": "EPSG:32633"}, )" +
                   to_utm),
            (Texts{"", "EPSG:32633"}));
  EXPECT_EQ(crs_of(R"([{"type": "readers.las", "filename": "metres.laz", "default_srs": "EPSG:32633"}, "p.laz"])"), Texts{""});
  // A file named twice is one cloud.
  EXPECT_EQ(crs_of(R"(["metres.laz", "./metres.laz", "p.laz"])"), Texts{""});
  EXPECT_THROW(read(R"([{"type": "readers.las", "filename": "bare.laz", "override_srs": "EPSG:32633"}, "feet.laz", "p.laz"])"), core::Error)
      << "nothing names the CRS of the products";
}

TEST_F(Pdal, HintsNameWhatAPipelineCanState) {
  const io::LasHeader bare = test::sample_header(6);
  test::write_sample("bare.laz", bare, test::sample_points(bare, 100), 1);
  const auto hint = [](const std::string& json) {
    try {
      read(json);
    } catch (const core::Error& e) {
      return e.hint();
    }
    return std::string();
  };
  EXPECT_NE(hint(R"(["bare.laz", "p.laz"])").find("override_srs"), std::string::npos);
  EXPECT_NE(hint(R"(["metres.laz", "feet.laz", "p.laz"])").find("out_srs"), std::string::npos);
  EXPECT_EQ(hint(R"(["bare.laz", "p.laz"])").find("--crs"), std::string::npos);
  EXPECT_EQ(hint(R"(["metres.laz", "feet.laz", "p.laz"])").find("--crs"), std::string::npos);
}

TEST_F(Pdal, SeveralRangesOfClassesMakeOneModel) {
  const Value c = config(chain(R"({"type": "filters.range", "limits": "Classification[2:2],Classification[9:9]"})",
                               R"({"type": "writers.gdal", "filename": "dtm.tif", "resolution": 1, "output_type": "idw"})"));
  EXPECT_EQ(io::to_json(*c.find("stage")->items()[1].find("classes")), io::to_json(io::parse_json("[2, 9]", "made")));
}

TEST_F(Pdal, PointsAreTransformedBeforeAllElse) {
  EXPECT_NE(fault_of(chain(R"({"type": "filters.smrf"}, {"type": "filters.reprojection", "out_srs": "EPSG:32610"})"))
                .find("filters.reprojection goes right behind the readers"),
            std::string::npos);
  EXPECT_NE(fault_of(chain(R"({"type": "writers.las", "filename": "a.laz"}, {"type": "filters.reprojection", "out_srs": "EPSG:32610"})")),
            "");
}

TEST_F(Pdal, AFileWithoutACrsTakesThatOfNothingElse) {
  io::LasHeader bare = test::sample_header(6);
  test::write_sample("bare.laz", bare, test::sample_points(bare, 100), 1);
  const auto refusal = [](const std::string& json) {
    try {
      read(json);
    } catch (const core::Error& e) {
      return e.text();
    }
    return std::string();
  };
  const std::string to_utm = R"({"type": "filters.reprojection", "out_srs": "EPSG:32610")";
  for (const std::string& json :
       {std::string(R"(["bare.laz", "p.laz"])"), R"(["bare.laz", )" + to_utm + R"(}, "p.laz"])",
        std::string(R"([{"type": "readers.las", "filename": "feet.laz", "override_srs": "EPSG:2994"}, "bare.laz", "p.laz"])")}) {
    EXPECT_NE(refusal(json).find("bare.laz: states no CRS"), std::string::npos) << refusal(json);
    EXPECT_NE(refusal(json).find("'override_srs'"), std::string::npos) << refusal(json);
  }
  EXPECT_EQ(refusal(R"(["bare.laz", )" + to_utm + R"(, "in_srs": "EPSG:32611"}, "p.laz"])"), "");
}

TEST_F(Pdal, AnIndexStatesTheCrsOfItsFiles) {
  const io::LasHeader h = test::sample_header(6);
  test::write_copc_sample("a.copc.laz", h, test::copc_points(h, 2000));
  test::write_ept("tile", "a.copc.laz");
  const Value survey = std::get<1>(read(R"([{"type": "readers.ept", "filename": "tile/ept.json", "default_srs": "EPSG:32633"}, "p.laz"])"));
  EXPECT_EQ(survey.find("points")->items()[0].find("crs"), nullptr);
}

TEST_F(Pdal, EveryStageThatBothHaveMakesAPlan) {
  test::write_bytes("x.json", R"([{"type": "readers.las", "filename": "metres.laz"}, {"type": "readers.las", "filename": "feet.laz"},
    {"type": "filters.merge"}, {"type": "filters.reprojection", "out_srs": "EPSG:32610"}, {"type": "filters.elm"}, {"type": "filters.outlier", "mean_k": 12},
    {"type": "filters.csf", "smooth": false}, {"type": "filters.hag_delaunay"}, {"type": "writers.las", "filename": "all.laz", "forward": "all", "scale_x": 0.01},
    {"type": "writers.copc", "filename": "all.copc.laz"}, {"type": "writers.gdal", "filename": "dsm.tif", "resolution": 1, "output_type": "max"}])");
  const Plan plan = make_plan({"x.json", {}, {}, {}});
  std::vector<std::string> types;
  for (const PlannedStage& s : plan.stages) types.emplace_back(s.stage->info().name);
  EXPECT_EQ(types,
            (std::vector<std::string>{"readers.las", "filters.noise", "filters.outlier", "filters.csf", "quality.lines", "terrain.dtm",
                                      "filters.hag_dem", "writers.las", "writers.copc", "terrain.dsm", "writers.gdal"}));
  EXPECT_EQ(plan.survey.crs, "EPSG:32610");
  EXPECT_EQ(plan.survey.points.size(), 2u);
  EXPECT_EQ(plan.run.output, "all");
  EXPECT_EQ(plan.runs_as.size(), 13u);
  EXPECT_THROW(make_plan({"x.json", {}, "survey.toml", {}}), core::Error) << "it names its clouds itself";
}

TEST_F(Pdal, WhatHasNoCounterpartIsRefusedWithItsPlace) {
  const auto refused = [](const std::string& json, const std::string& why) {
    const std::string text = fault_of(json);
    EXPECT_NE(text.find(why), std::string::npos) << json << "\n" << text;
  };
  refused(chain(R"({"type": "filters.sample", "radius": 1})"), "'filters.sample' has no counterpart here");
  refused(chain(R"({"type": "filters.sample", "radius": 1})"), "nearest is filters.key_points");
  refused(chain(R"({"type": "filters.smrf", "ignore": "Classification[6:6]"})"), "filters.smrf: 'ignore'");
  refused(chain(R"({"type": "filters.assign", "value": "Classification = 0"})"), "leave it out where it clears classes");
  refused(chain(R"({"type": "filters.smrf", "cell": "wide"})"), "'cell' is not a number");
  refused(chain(ground), "points of other classes would be deleted before writers.las");
  refused(chain(ground), "every point is written with its class");
  refused(chain(R"({"type": "filters.range", "limits": "Z[0:100]"})"), "filters flag points and never delete them");
  refused(chain(R"({"type": "filters.outlier", "method": "cluster"})"), "filters.outlier: 'method' = cluster");
  refused(chain(R"({"type": "filters.outlier", "method": "radius", "mean_k": 8})"), "filters.outlier: 'mean_k'");
  refused(chain(R"({"type": "filters.outlier", "radius": 2})"), "filters.outlier: 'radius'");
  refused(chain(R"({"type": "filters.smrf", "method": "statistical"})"), "filters.smrf: 'method'");
  refused(chain(R"({"type": "filters.smrf", "inputs": ["a"]})"), "branches");
  refused(chain("", R"({"type": "writers.gdal", "filename": "a.tif", "resolution": 1, "output_type": "idw"})"), "the mean of all points");
  refused(chain(ground, R"({"type": "writers.gdal", "filename": "a.tif", "resolution": 1})"), "output_type 'all'");
  refused(chain(ground, R"({"type": "writers.gdal", "filename": "a.tif", "output_type": "idw"})"), "no 'resolution'");
  refused(chain("", R"({"type": "writers.text", "filename": "a.txt"})"), "'writers.text' has no counterpart here");
  refused(R"(["metres.laz", {"type": "filters.smrf"}])", "no writer");
  refused(R"([{"type": "filters.smrf"}, "out.laz"])", "does not begin with a reader");
  refused(R"({"pipeline": []})", "has no stages");
  refused(R"(["metres.laz", 7])", "a table or the name of a file");
}

TEST_F(Pdal, BoundsAndResolutionOfReadersThatHaveThem) {
  const auto reader_with = [](const std::string& bounds) {
    return chain("", "\"p.laz\"", R"({"type": "readers.copc", "filename": "feet.laz", "resolution": 10, "bounds": ")" + bounds + "\"}");
  };
  const Value c = config(reader_with("([1, 2.5], [3, 4])"));
  const Value& reader = c.find("stage")->items()[0];
  EXPECT_EQ(io::to_json(*reader.find("bounds")), io::to_json(io::parse_json("[1.0, 3.0, 2.5, 4.0]", "made")));
  EXPECT_EQ(reader.find("resolution")->as_text(), "3.048 m");
  EXPECT_NE(fault_of(reader_with("([1, 2], [3, 4], [5, 6])")), "");
}

TEST(PdalPipeline, OursIsNotOne) {
  EXPECT_FALSE(is_pdal_pipeline(io::parse_json(R"({"run": {}, "stage": []})", "x.json")));
  EXPECT_TRUE(is_pdal_pipeline(io::parse_json("[]", "x.json")));
}

}  // namespace
}  // namespace swath::pipeline
