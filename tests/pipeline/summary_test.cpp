// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/summary.h"

#include <gtest/gtest.h>

#include "io/value_file.h"

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

TEST(Summary, AnErrorBehindAJudgedGeometryHintsAtWhatIsNamed) {
  const core::Value geometry = io::parse_json(
      R"({"named": ["range_centimetres"], "warnings": ["lines disagree", "with ranges in centimetres: state range_unit"]})", "report");
  const core::Error e("no return could be georeferenced", "survey.toml", "compare the times", core::Exit::bad_data);
  EXPECT_EQ(with_geometry(e, &geometry).hint(), "compare the times; quality.geometry: with ranges in centimetres: state range_unit");
  EXPECT_EQ(with_geometry(e, &geometry).code(), core::Exit::bad_data);
  EXPECT_EQ(with_geometry(e, nullptr).hint(), "compare the times");
  const core::Value sound = io::parse_json(R"({"named": [], "warnings": []})", "report");
  EXPECT_EQ(with_geometry(e, &sound).hint(), "compare the times");
}

}  // namespace
}  // namespace swath::pipeline
