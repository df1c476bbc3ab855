// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/summary.h"

#include <gtest/gtest.h>

#include "io/text/value_file.h"

namespace swath::pipeline {
namespace {

TEST(Summary, TellsCountsTalliesAndFindings) {
  const core::Value report = io::parse_json(
      R"({"seconds": 72, "stages": [{"type": "georeference", "counts": {"in": 10, "out": 9},
          "tally": {"outside the trajectory, left out": {"count": 1, "examples": ["record 3"]}}, "findings": {"rms_3d": 0.021234567}}]})",
      "report");
  const std::string text = summary(report, "out");
  for (const char* part : {"georeference: 10 in, 9 out", "outside the trajectory, left out: 1  (record 3)", "rms_3d: 0.02123", "1 m 12 s"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
}

TEST(Summary, DeclaredFindingsHaveTheirUnitAndDetailsStayInTheReport) {
  const core::Value report = io::parse_json(
      R"({"seconds": 72, "stages": [{"type": "report.truth", "findings": {"rms_3d": 0.021234567, "points": {"rms_up_m": 0.5},
          "dtm": {"cells": 7, "rms_m": 0.0345678}}}]})",
      "report");
  const std::string text = summary(report, "out");
  for (const char* part : {"rms_3d: 0.021 m\n", "rms_m: 0.035 m\n"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  for (const char* part : {"rms_up_m", "points", "cells"}) EXPECT_EQ(text.find(part), std::string::npos) << part << " in\n" << text;
}

TEST(Summary, AListOfTablesIsALineForEachAndNoJson) {
  std::string pairs;
  for (int k = 0; k < 8; ++k)
    pairs += (k ? ", " : "") + std::string(R"({"name": "line )") + std::to_string(k) + R"(", "rms": 0.021234567})";
  const core::Value report =
      io::parse_json(R"({"seconds": 72, "stages": [{"type": "a stage", "findings": {"pairs": [)" + pairs + "]}}]}", "report");
  const std::string text = summary(report, "out");
  EXPECT_NE(text.find("    pairs\n      name line 0, rms 0.02123\n      name line 1"), std::string::npos) << text;
  EXPECT_NE(text.find("      and 2 more: report.json\n"), std::string::npos) << text;
  EXPECT_EQ(text.find('{'), std::string::npos) << text;
}

TEST(Summary, EmptyListsAreNotShown) {
  const core::Value report = io::parse_json(
      R"({"seconds": 72, "stages": [{"type": "some.stage", "findings": {"lines": [], "named": [], "marks": 3}}]})", "report");
  const std::string text = summary(report, "out");
  EXPECT_EQ(text.find("[]"), std::string::npos) << text;
  EXPECT_NE(text.find("marks: 3"), std::string::npos) << text;
}

TEST(Summary, LinesForAnotherFileAreShownAsLines) {
  const core::Value report = io::parse_json(
      R"({"seconds": 72, "stages": [{"type": "calib.lever_arm", "findings": {"survey_toml": "[mounting]\nlever_arm = [1, 2, 3]\n"}}]})",
      "report");
  const std::string text = summary(report, "out");
  EXPECT_NE(text.find("    survey_toml:\n      [mounting]\n      lever_arm = [1, 2, 3]\n"), std::string::npos) << text;
}

TEST(Summary, AnErrorBehindAJudgedGeometryHintsAtWhatIsNamed) {
  const core::Value geometry = io::parse_json(
      R"({"named": ["range_centimetres"], "warnings": ["lines disagree", "with ranges in centimetres: state range_unit"]})", "report");
  const core::Error e("no return could be georeferenced", "survey.toml", "compare the times", core::Exit::bad_data);
  EXPECT_EQ(with_geometry(e, &geometry, {}).hint(), "compare the times; quality.geometry: with ranges in centimetres: state range_unit");
  EXPECT_EQ(with_geometry(e, &geometry, {}).code(), core::Exit::bad_data);
  EXPECT_EQ(with_geometry(e, nullptr, {}).hint(), "compare the times");
  const core::Value sound = io::parse_json(R"({"named": [], "warnings": []})", "report");
  EXPECT_EQ(with_geometry(e, &sound, {}).hint(), "compare the times");
}

TEST(Summary, AnErrorOfAnotherFileOrOfTheConfigHasAnotherCause) {
  const core::Value geometry =
      io::parse_json(R"({"named": ["range_feet"], "warnings": ["with ranges in feet: state range_unit"]})", "report");
  const std::vector<std::filesystem::path> inputs{"/survey/laser.npy", "/survey/edges.geojson"};
  const auto hint = [&](const std::string& where, core::Exit code) {
    return with_geometry(core::Error("a fault", where, "", code), &geometry, inputs).hint();
  };
  EXPECT_EQ(hint("/survey/edges.geojson: feature 3", core::Exit::bad_data), "");
  EXPECT_EQ(hint("edges.geojson: feature 3", core::Exit::bad_data), "");
  EXPECT_EQ(hint("pipeline.toml:3:1", core::Exit::bad_usage), "");
  EXPECT_EQ(hint("simulated", core::Exit::bad_data), "quality.geometry: with ranges in feet: state range_unit");
}

TEST(Summary, PointsOutsideTheBoxOfTheirFilesHeaderAreAWarning) {
  const core::Value report = io::parse_json(
      R"({"seconds": 72, "stages": [{"type": "readers.las", "tally": {"points outside the box of their file's header": {"count": 4},
          "flight lines or files with points well outside the box of a header":
          {"count": 1, "examples": ["a.las: 4 of 100 points (4 %) lie outside"]}}}]})",
      "report");
  const std::string text = summary(report, "out");
  EXPECT_NE(text.find("\nwarning [points.outside_box]: a.las: 4 of 100 points (4 %) lie outside\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("more"), std::string::npos) << text;
}

TEST(Summary, FilesWithAWrongBoxThatAreNotNamedAreCounted) {
  const core::Value report = io::parse_json(
      R"({"seconds": 72, "stages": [{"type": "readers.las", "tally": {
          "flight lines or files with points well outside the box of a header":
          {"count": 12, "examples": ["a.las: 4 of 100", "b.las: 3 of 100", "c.las: 2 of 100"]}}}]})",
      "report");
  const std::string text = summary(report, "out");
  EXPECT_NE(text.find("\nwarning [points.outside_box]: c.las: 2 of 100\n\nwarning [points.outside_box]: and 9 more flight lines or files"),
            std::string::npos)
      << text;
}

TEST(Summary, BoundsRoundedToFewerDigitsAreNoWarning) {
  const core::Value report = io::parse_json(
      R"({"seconds": 72, "stages": [{"type": "readers.las", "tally": {"points outside the box of their file's header":
          {"count": 4, "examples": ["a.las: 4 of 100 points (4 %) lie outside"]}}}]})",
      "report");
  EXPECT_EQ(summary(report, "out").find("warning"), std::string::npos);
}

}  // namespace
}  // namespace swath::pipeline
