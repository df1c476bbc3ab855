// SPDX-License-Identifier: GPL-3.0-or-later
// A survey of one CSD file: its records bear their own poses, and no [[trajectory]] is named.
#include <array>
#include <cmath>
#include <cstring>

#include "io/text/binary_file.h"
#include "io/text/value_file.h"
#include "pipeline/run.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

constexpr int pulses = 2000;

/// A straight flight to the north at 50 m/s, 1000 m high, over a sphere near enough to the ellipsoid; one return straight below.
std::string made_csd() {
  std::string out(2048, '\0');
  auto* b = reinterpret_cast<unsigned char*>(out.data());
  std::memcpy(b, "CSD\0Optech Incorporated", 23);
  io::store<std::uint16_t>(b + 104, 2048);
  io::store<std::uint16_t>(b + 106, 1660);
  io::store<std::uint32_t>(b + 124, pulses);
  for (int i = 0; i < pulses; ++i) {
    std::array<unsigned char, 69> p{};
    io::store(p.data(), 1000.0 + 0.01 * i);
    p[8] = 1;
    io::store(p.data() + 9, 700.0F);
    io::store<std::uint16_t>(p.data() + 25, 10);
    io::store(p.data() + 49, 0.6 + 0.5 * i / 6371000.0);
    io::store(p.data() + 57, -1.2);
    io::store(p.data() + 65, 1000.0F);
    out.append(reinterpret_cast<const char*>(p.data()), p.size());
  }
  return out;
}

TEST(CsdSurvey, ItsOwnPosesServe) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.csd", made_csd());
  test::write_bytes(folder / "survey.toml",
                    "name = \"csd\"\ncrs = \"EPSG:32619\"\ncalibration_file = \"a.csd\"\n[[laser]]\nfile = \"a.csd\"\n");
  Request r;
  r.config = test::source_folder() / "configs/georeference.toml";
  r.survey = folder / "survey.toml";
  r.output = folder / "out";
  Plan plan = make_plan(r);
  Progress progress(Voice::quiet);
  const core::Value report = run(plan, progress, "test").report;
  std::int64_t out = 0;
  for (const core::Value& s : report.find("stages")->items())
    if (s.find("type")->as_text() == "georeference") out = s.find("counts")->find("out")->as_int();
  EXPECT_EQ(out, pulses);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/points"));
}

}  // namespace
}  // namespace swath::pipeline
