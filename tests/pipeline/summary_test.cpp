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

}  // namespace
}  // namespace swath::pipeline
