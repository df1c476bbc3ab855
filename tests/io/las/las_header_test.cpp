// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/las_header.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "core/error.h"
#include "io/las/las_bytes.h"
#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

std::string sample_bytes(const test::TemporaryFolder& folder, int format = 6, int minor = -1) {
  const LasHeader h = test::sample_header(format, minor);
  test::write_sample(folder / "good.las", h, test::sample_points(h, 10));
  return test::read_bytes(folder / "good.las");
}

template <class T>
std::string with(std::string bytes, std::size_t at, T value) {
  std::memcpy(&bytes[at], &value, sizeof value);
  return bytes;
}

/// The error of reading the bytes as a header; fails the test where there is none.
std::string fault(const test::TemporaryFolder& folder, const std::string& bytes) {
  test::write_bytes(folder / "bad.las", bytes);
  try {
    std::vector<std::string> warnings;
    read_las_header(folder / "bad.las", warnings);
  } catch (const core::Error& e) {
    EXPECT_NE(e.where().find("bad.las"), std::string::npos);
    EXPECT_FALSE(e.hint().empty()) << e.text();
    return e.text();
  }
  ADD_FAILURE() << "no error";
  return {};
}

TEST(LasHeader, LayoutsHaveTheSizesOfTheSpecification) {
  const std::array<int, 11> sizes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  for (int f = 0; f <= 10; ++f) EXPECT_EQ(las_layout(f)->size, sizes[static_cast<std::size_t>(f)]) << f;
  EXPECT_FALSE(las_layout(11));
}

TEST(LasHeader, ComesBackInEveryVersion) {
  const test::TemporaryFolder folder;
  for (int minor = 0; minor <= 4; ++minor) {
    LasHeader h = test::sample_header(1, minor);
    h.creation_day = 325;
    h.creation_year = 2026;
    h.vlrs.push_back({"someone", 77, "a record", {1, 2, 3}, 0, 0});
    if (minor == 4) h.evlrs.push_back({"someone", 78, "a long record", std::vector<std::uint8_t>(100000, 5), 0, 0});
    const LasPoints p = test::sample_points(h, 20);
    test::write_sample(folder / "a.las", h, p);
    std::vector<std::string> warnings;
    const LasHeader r = read_las_header(folder / "a.las", warnings);
    EXPECT_EQ(r.version_minor, minor);
    EXPECT_EQ(r.point_count, 20u);
    EXPECT_EQ(r.creation_day, 325);
    EXPECT_EQ(r.creation_year, 2026);
    EXPECT_EQ(r.system_identifier, "test");
    EXPECT_EQ(r.generating_software, "swath tests");
    EXPECT_EQ(r.file_source_id, 7);
    EXPECT_EQ(r.scale, h.scale);
    EXPECT_EQ(r.offset, h.offset);
    EXPECT_EQ(r.min.x(), *std::min_element(p.x.begin(), p.x.end()));
    EXPECT_EQ(r.max.z(), *std::max_element(p.z.begin(), p.z.end()));
    ASSERT_EQ(r.vlrs.size(), 1u);
    EXPECT_EQ(r.vlrs[0].data, h.vlrs[0].data);
    EXPECT_EQ(r.vlrs[0].user_id, "someone");
    ASSERT_EQ(r.evlrs.size(), h.evlrs.size());
    for (std::size_t i = 0; i < h.evlrs.size(); ++i) EXPECT_EQ(r.evlrs[i].data, h.evlrs[i].data);
    EXPECT_EQ(warnings.size(), minor == 0 ? 1u : 0u);  // LAS 1.0 cannot say that its times are adjusted
  }
}

TEST(LasHeader, EveryFaultIsNamedWithItsByte) {
  const test::TemporaryFolder folder;
  const std::string good = sample_bytes(folder);
  EXPECT_NE(fault(folder, with(good, 0, 'X')).find("byte 0: not a LAS file"), std::string::npos);
  EXPECT_NE(fault(folder, "").find("not a LAS file"), std::string::npos);
  EXPECT_NE(fault(folder, with(good, 25, char{5})).find("byte 24: LAS 1.5"), std::string::npos);
  EXPECT_NE(fault(folder, with(good, 24, char{2})).find("LAS 2.4"), std::string::npos);
  EXPECT_NE(fault(folder, with(good, 104, char{11})).find("point format 11"), std::string::npos);
  EXPECT_NE(fault(folder, with(good, 105, std::uint16_t{29})).find("byte 105: point records of 29 bytes"), std::string::npos);
  EXPECT_NE(fault(folder, with(good, 131, std::numeric_limits<double>::quiet_NaN())).find("byte 131: the scale factor of x"),
            std::string::npos);
  EXPECT_NE(fault(folder, with(good, 139, 0.0)).find("scale factor of y"), std::string::npos);
  EXPECT_NE(fault(folder, with(good, 147, -1e305)).find("the scale factor of z is -1e+305"), std::string::npos);
  EXPECT_NE(fault(folder, with(good, 155, 1e308)).find("the offset of x is 1e+308"), std::string::npos);
  EXPECT_NE(fault(folder, with(good, 171, std::numeric_limits<double>::infinity())).find("byte 171: the offset of z"), std::string::npos);
  EXPECT_NE(fault(folder, with(good, 247, std::uint64_t{11})).find("counts 11 points, the file holds 10"), std::string::npos);
  EXPECT_NE(fault(folder, with(good, 247, ~std::uint64_t{0})).find("the file holds 10"), std::string::npos);
  EXPECT_NE(fault(folder, with(with(good, 107, std::uint32_t{9}), 247, std::uint64_t{8})).find("byte 107: the legacy point count 9"),
            std::string::npos);
  EXPECT_NE(fault(folder, with(good, 100, std::uint32_t{1000})).find("variable length record 0 reaches beyond"), std::string::npos);
  EXPECT_NE(fault(folder, with(good, 94, std::uint16_t{227})).find("byte 94"), std::string::npos);
  EXPECT_NE(fault(folder, with(good, 96, std::uint32_t{1u << 30})).find("point data is cut off"), std::string::npos);
  EXPECT_NE(fault(folder, with(with(good, 243, std::uint32_t{1}), 235, std::uint64_t{good.size() - 10}))
                .find("extended variable length record 0"),
            std::string::npos);
  EXPECT_NE(fault(folder, with(good, 104, char(6 | 0x80))).find("laszip record is missing"), std::string::npos);
  std::vector<std::string> warnings;
  EXPECT_THROW(read_las_header(folder / "none.las", warnings), core::Error);
  EXPECT_THROW(read_las_header(folder.path(), warnings), core::Error);
}

TEST(LasHeader, OddButHarmlessIsAWarning) {
  const test::TemporaryFolder folder;
  const std::string good = sample_bytes(folder);
  const auto warning = [&](const std::string& bytes) {
    test::write_bytes(folder / "odd.las", bytes);
    std::vector<std::string> warnings;
    read_las_header(folder / "odd.las", warnings);
    return warnings.size() == 1 ? warnings[0] : std::to_string(warnings.size()) + " warnings";
  };
  EXPECT_NE(warning(with(good, 6, std::uint16_t{16})).find("GPS time bit"), std::string::npos);
  EXPECT_NE(warning(with(good, 6, std::uint16_t{1})).find("WKT bit"), std::string::npos);
  EXPECT_NE(warning(good + "tail").find("4 bytes after the last point"), std::string::npos);
  EXPECT_NE(warning(with(good, 255, std::uint64_t{1000})).find("add up to"), std::string::npos);
  EXPECT_NE(warning(with(good, 107, std::uint32_t{10})).find("legacy point count is set"), std::string::npos);
}

TEST(LasHeader, OfTwoCountsTheOneThatTheFileBearsOutIsTaken) {
  const test::TemporaryFolder folder;
  const std::string good = sample_bytes(folder, 1, 4);  // both counts are 10
  const auto read = [&](const std::string& bytes, const std::string& warning) {
    test::write_bytes(folder / "two.las", bytes);
    std::vector<std::string> warnings;
    const LasHeader h = read_las_header(folder / "two.las", warnings);
    EXPECT_EQ(warnings.empty() ? "" : warnings.front(), warning);
    EXPECT_EQ(h.point_count, 10u);
    EXPECT_EQ(std::accumulate(h.by_return.begin(), h.by_return.end(), std::uint64_t{0}), 10u);
  };
  std::string only_legacy = with(good, 247, std::uint64_t{0});
  for (std::size_t i = 0; i < 15; ++i) only_legacy = with(only_legacy, 255 + 8 * i, std::uint64_t{0});
  read(only_legacy, "the legacy point count 10 contradicts the point count 0: the legacy one is taken");
  read(with(good, 247, std::uint64_t{12}), "the legacy point count 10 contradicts the point count 12: the legacy one is taken");
  read(with(good, 107, std::uint32_t{9}), "the legacy point count 9 contradicts the point count 10: the legacy one is not used");
  // Compressed points do not tell; the lower half of a count beyond 32 bits is no contradiction.
  const std::string packed = with(good, 104, char(1 | 0x80)), many = with(packed, 247, (std::uint64_t{1} << 32) + 10);
  EXPECT_NE(fault(folder, with(packed, 247, std::uint64_t{12})).find("the legacy point count 10 contradicts"), std::string::npos);
  EXPECT_NE(fault(folder, many).find("laszip record is missing"), std::string::npos);
}

TEST(LasHeader, TheVersionMustHoldTheFormat) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(LasRawWriter(folder / "a.las", test::sample_header(6, 3)), core::Error);
  EXPECT_THROW(LasRawWriter(folder / "a.laz", test::sample_header(2, 1)), core::Error);
  EXPECT_THROW(LasRawWriter(folder / "a.laz", test::sample_header(11, 4)), core::Error);
  LasHeader h = test::sample_header(6);
  h.vlrs.push_back({"x", 1, "", std::vector<std::uint8_t>(70000), 0, 0});
  EXPECT_THROW(LasRawWriter(folder / "a.las", h), core::Error);
  EXPECT_EQ(test::entries(folder.path()), 0u);
}

}  // namespace
}  // namespace swath::io
