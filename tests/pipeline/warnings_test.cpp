// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/report_warnings.h"

#include <gtest/gtest.h>

#include <set>

#include "core/error.h"
#include "io/text/value_file.h"

namespace swath::pipeline {
namespace {

TEST(Warnings, EveryWarningOfAReportHasACodeThatCanBeLookedUp) {
  const core::Value report = io::parse_json(
      R"json({"pieces_damaged": 2, "control_unused": ["a.csv (use = \"control\")"], "over_memory": ["calib.network took 3 GB"], "stages": [{"type": "readers.las", "tally": {
          "flight lines or files with points well outside the box of a header": {"count": 4, "examples": ["a.las: 4 of 100"]}}},
          {"type": "readers.laser", "records": [{"name": "records", "read": 1000}], "tally": {"records outside every line, left out": {"count": 300}}},
          {"type": "georeference", "counts": {"in": 700, "out": 600}, "tally": {"outside the trajectory, left out": {"count": 100}}},
          {"type": "quality.points", "findings": {"named": [{"code": "check.heights", "sentence": "a"}, {"code": "check.line", "sentence": "b"},
                                                            {"code": "check.mark", "sentence": "c"}, {"code": "check.few", "sentence": "d"},
                                                            {"code": "check.names", "sentence": "e"}, {"code": "check.outside", "sentence": "f"},
                                                            {"code": "check.roof", "sentence": "g"}, {"code": "check.cover", "sentence": "i"}]}},
          {"type": "trajectory.ins_gnss", "findings": {"fixes": {"used": 1061, "down_weighted": 316, "sigmas_overstated": 2.9}, "imu_noise_factor": 64,
              "named": [{"code": "trajectory.clocks", "sentence": "j"}, {"code": "trajectory.fix_step", "sentence": "m"}, {"code": "trajectory.heading", "sentence": "n"}, {"code": "trajectory.lever_arm", "sentence": "k"}, {"code": "trajectory.motion", "sentence": "l"}]}},
          {"type": "calib.network", "findings": {"findings": ["line 3: the surfaces move the trajectory: look at its fixes"]}},
          {"type": "quality.density", "findings": {"pulses": 900, "duplicates": 100, "duplicate_share": 0.1}},
          {"type": "time.sync", "findings": {"outside": [{"technique": "pc", "events": 40, "outside": 40, "sentence": "h"}]}},
          {"type": "terrain.contours", "findings": {"lines": 0, "left_out": 41}}, {"type": "terrain.contours", "findings": {"lines": 3, "left_out": 4, "map_class": "none", "model_sigma_m": 0.08, "findings": ["o"]}},
          {"type": "quality.surface", "findings": {"undeclared": "ref.tif: 3 heights of -9999"}},
          {"type": "terrain.buildings", "findings": {"buildings": 0, "returns": 0}}, {"type": "terrain.buildings", "findings": {"returns": 7}},
          {"type": "terrain.powerlines", "findings": {"spans": 0, "unused_wire_returns": 12}}, {"type": "terrain.powerlines", "findings": {"spans": 3, "unused_wire_returns": 12}}],
          "inputs": [{"file": "a.laz", "bytes": 9, "xxh3": "1"}, {"file": "copy.LAZ", "bytes": 9, "xxh3": "1"}],
          "crs": {"name": "WGS 84 / Arctic", "scale": 0.97, "degrees_outside": 12.5},
          "geometry": {"named": ["range_feet"], "warnings": ["lines disagree", "with ranges in feet: state range_unit"]},
          "limits": [{"name": "outside", "value": 0.3, "limit": 0.1, "held": false, "excess": 0.2},
                     {"name": "voids", "value": null, "limit": 0.1, "held": false, "excess": null},
                     {"name": "truth_rms", "value": 1, "limit": 0.1, "held": false, "excess": 0.9},
                     {"name": "line_difference", "value": 1, "limit": 0.1, "held": false, "excess": 0.9},
                     {"name": "overlap_difference", "value": 1, "limit": 0.1, "held": false, "excess": 0.9},
                     {"name": "void_share", "value": 0.3, "limit": 0.1, "held": false, "excess": 0.2},
                     {"name": "nva", "value": 1, "limit": 0.1, "held": false, "excess": 0.9},
                     {"name": "planimetry", "value": 1, "limit": 0.1, "held": false, "excess": 0.9},
                     {"name": "vva", "value": 1, "limit": 0.1, "held": false, "excess": 0.9},
                     {"name": "surface_difference", "value": 1, "limit": 0.1, "held": false, "excess": 0.9},
                     {"name": "quality_level", "value": 2, "limit": 0, "held": false, "excess": 2},
                     {"name": "contradictions", "value": 1, "limit": 0, "held": false, "excess": 1}]})json",
      "report");
  std::set<std::string> codes;
  for (const Warning& w : warnings_in(report)) {
    codes.insert(w.code);
    EXPECT_FALSE(w.text.empty());
    EXPECT_NE(warning_help(w.code).find(w.code + ": "), std::string::npos);
  }
  EXPECT_EQ(codes.size(), warning_kinds().size());
}

TEST(Warnings, TheListHasABlankBehindEveryCode) {
  for (const WarningKind& k : warning_kinds()) EXPECT_NE(warning_help("").find(std::string(k.code) + " "), std::string::npos) << k.code;
}

TEST(Warnings, EventsOfATechniqueAreNamedOnceThoughTwoStagesFindThem) {
  const auto found = [](const std::string& technique, const std::string& record) {
    return R"({"outside": [{"technique": ")" + technique + R"(", "events": 4, "outside": 4, "sentence": "all 4 events of ')" + technique +
           "' lie outside the " + record + R"("}]})";
  };
  const auto number = [&](const std::string& other) {
    return warnings_in(io::parse_json(R"({"stages": [{"type": "time.sync", "findings": )" + found("pc", "trajectory") +
                                          R"(}, {"type": "trajectory.kinematic", "findings": )" + found(other, "GNSS record") + "}]}",
                                      "report"))
        .size();
  };
  EXPECT_EQ(number("pc"), 1u);
  EXPECT_EQ(number("camera"), 2u);
}

TEST(Warnings, WhatAnAdjustmentFoundIsNamedEach) {
  const auto found = warnings_in(io::parse_json(R"({"stages": [{"type": "calib.strips", "findings": {"findings": []}},
      {"type": "calib.network", "findings": {"findings": ["line 3: a", "line 4: b"]}},
      {"type": "quality.geometry", "findings": {"findings": ["c"]}}]})",
                                                "report"));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].code, "calib.finding");
  EXPECT_EQ(found[1].text, "line 4: b");
}

TEST(Warnings, AFewContradictingFixesAreNoWarning) {
  const auto number = [](const std::string& findings) {
    return warnings_in(io::parse_json(R"({"stages": [{"type": "trajectory.ins_gnss", "findings": )" + findings + "}]}", "report")).size();
  };
  EXPECT_EQ(number(R"({"fixes": {"used": 1000, "down_weighted": 50}, "imu_noise_factor": 4})"), 0u);
  EXPECT_EQ(number(R"({"fixes": {"used": 1000, "down_weighted": 51}, "imu_noise_factor": 4})"), 1u);
  EXPECT_EQ(number(R"({"fixes": {"used": 60, "down_weighted": 10}})"), 0u);
  EXPECT_EQ(number(R"({"imu_noise_factor": 40})"), 1u);
  EXPECT_EQ(number(R"({"fixes": {"used": 60, "down_weighted": 0, "correlated_share": 0.94}})"), 0u);
  EXPECT_EQ(number(R"({"fixes": {"used": 60, "down_weighted": 0, "sigmas_overstated": 3}})"), 1u);
}

TEST(Warnings, RecordsThatNothingCoversAreNamedWithFileAndTimes) {
  const auto warned = [](const std::string& count, const std::string& files) {
    return warnings_in(io::parse_json(R"({"stages": [{"type": "georeference", "counts": {"in": 10000, "out": 0},
        "tally": {"outside the trajectory, left out": {"count": )" +
                                          count + R"(, "files": [)" + files + "]}}}]}",
                                      "report"));
  };
  const auto file = [](const std::string& name) {
    return R"({"file": ")" + name + R"(", "count": 55, "first_s": 1401485000.5, "last_s": 1401485010.25})";
  };
  EXPECT_TRUE(warned("100", file("a.las")).empty());  // 1 %
  const auto one = warned("110", file("a.las") + "," + file("b.las"));
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].code, "laser.outside_trajectory");
  EXPECT_NE(one[0].text.find("110 of 10000 returns lie outside the trajectory or in its gaps (1.1 %)"), std::string::npos) << one[0].text;
  EXPECT_NE(one[0].text.find("a.las: 55 from 2024-06-03T21:23:02.500Z to 2024-06-03T21:23:12.250Z; b.las: 55"), std::string::npos)
      << one[0].text;
  const auto many = warned("9999", file("a") + "," + file("b") + "," + file("c") + "," + file("d") + "," + file("e"));
  EXPECT_NE(many[0].text.find("and 2 more files"), std::string::npos) << many[0].text;
  EXPECT_EQ(many[0].text.find("d: 55"), std::string::npos) << many[0].text;
}

TEST(Warnings, TurnsThatWereScannedAreNoWarning) {
  const auto number = [](const std::string& count) {
    return warnings_in(io::parse_json(R"({"stages": [{"type": "readers.laser", "records": [{"name": "records", "read": 1000}],
        "tally": {"records outside every line, left out": {"count": )" +
                                          count + "}}}]}",
                                      "report"))
        .size();
  };
  EXPECT_EQ(number("200"), 0u);
  EXPECT_EQ(number("201"), 1u);
}

TEST(Warnings, OneDuplicateIn1000IsNoWarning) {
  const auto number = [](const std::string& share) {
    return warnings_in(io::parse_json(R"({"stages": [{"type": "quality.density", "findings": {"pulses": 1000, "duplicates": 1, )"
                                      R"("duplicate_share": )" +
                                          share + "}}]}",
                                      "report"))
        .size();
  };
  EXPECT_EQ(number("0.00099"), 0u);
  EXPECT_EQ(number("0.0011"), 1u);
}

TEST(Warnings, CloudsWithTheSameBytesAreNamedBoth) {
  const auto warned = [](const std::string& inputs) {
    return warnings_in(io::parse_json(R"({"stages": [], "inputs": [)" + inputs + "]}", "report"));
  };
  const auto input = [](const std::string& file, int bytes, const std::string& hash) {
    return R"({"file": ")" + file + R"(", "bytes": )" + std::to_string(bytes) + R"(, "xxh3": ")" + hash + "\"}";
  };
  const auto same = warned(input("a.laz", 9, "1") + "," + input("b.laz", 9, "2") + "," + input("copy.LAZ", 9, "1"));
  ASSERT_EQ(same.size(), 1u);
  EXPECT_EQ(same[0].code, "clouds.same_file");
  EXPECT_NE(same[0].text.find("copy.LAZ holds the same bytes as a.laz"), std::string::npos) << same[0].text;
  EXPECT_TRUE(warned(input("a.laz", 9, "1") + "," + input("b.laz", 8, "1")).empty());
  EXPECT_TRUE(warned(input("a.prj", 9, "1") + "," + input("b.prj", 9, "1")).empty()) << "only clouds have points";
  std::string many = input("a.las", 9, "1");
  for (int k = 0; k < 8; ++k) many += "," + input(std::to_string(k) + ".las", 9, "1");
  const auto capped = warned(many);
  ASSERT_EQ(capped.size(), 6u);
  EXPECT_NE(capped.back().text.find("3 more"), std::string::npos) << capped.back().text;
}

TEST(Warnings, AnUnknownCodeNamesTheNearest) {
  try {
    warning_help("limit.void");
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_EQ(e.hint(), "did you mean 'limit.voids'?");
    EXPECT_EQ(e.code(), core::Exit::bad_usage);
  }
}

TEST(Warnings, TheListNamesEveryCode) {
  const std::string list = warning_help("");
  for (const WarningKind& k : warning_kinds()) EXPECT_NE(list.find(k.code), std::string::npos) << k.code;
}

}  // namespace
}  // namespace swath::pipeline
