// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/las_writer.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "core/geo/crs.h"
#include "io/laz/swath_laz.h"
#include "tests/io/file_size_limit.h"
#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

core::Block sample_block(std::size_t n) {
  core::Block b;
  b.origin = {512000.0, 5403000.0, 0.0};
  core::ColumnSet all;
  core::for_each_column([&](core::Column c, const char*, auto) { all.add(c); });
  core::resize(b, n);
  core::add_columns(b, all);
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i);
    b.x[i] = 0.1234 * t;
    b.y[i] = 300.0 - 0.37 * t;
    b.z[i] = 40.0 * std::sin(t);
    b.time[i] = 1.4e9 + 1e-5 * t;
    b.intensity[i] = static_cast<std::uint16_t>(i * 31);
    b.return_count[i] = 15;
    b.return_number[i] = static_cast<std::uint8_t>(1 + i % 15);
    b.classification[i] = static_cast<std::uint8_t>(i % 19);
    b.flags[i] = static_cast<std::uint16_t>(i % 64);
    b.scan_angle[i] = static_cast<float>((-30.0 + 0.06 * static_cast<double>(i % 1000)) * degree);
    b.strip[i] = static_cast<std::uint16_t>(1 + i % 3);
    b.record[i] = static_cast<std::uint32_t>(i);
    b.range[i] = static_cast<float>(500.0 + 0.25 * static_cast<double>(i % 100));
    b.incidence[i] = static_cast<float>(0.01 * static_cast<double>(i % 90));
    b.sigma_h[i] = 0.04f;
    b.sigma_v[i] = i % 10 == 0 ? std::numeric_limits<float>::quiet_NaN() : 0.0234f;
    b.height[i] = static_cast<float>(-1.0 + 0.125 * static_cast<double>(i % 64));
    b.ground_probability[i] = i % 7 == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(i % 101) / 100.0f;
    b.red[i] = static_cast<std::uint16_t>(i);
    b.green[i] = 256;
    b.blue[i] = 65535;
    b.user_data[i] = static_cast<std::uint8_t>(i);
  }
  return b;
}

LasWriteOptions options() {
  LasWriteOptions o;
  o.crs_wkt = core::Crs("EPSG:32632").wkt1();
  return o;
}

TEST(LasWriter, ABlockComesBackWithinItsSteps) {
  // Half a step of every field, and the rounding of the Block's own floats.
  constexpr double half_mm = 0.0005 + 1e-9, half_angle = 0.003 * degree + 1e-7;
  const test::TemporaryFolder folder;
  const core::Block b = sample_block(3000);
  for (const char* name : {"a.las", "a.laz"}) {
    LasWriter w(folder / name, options());
    w.write(b);
    EXPECT_EQ(w.count(), 3000u);
    w.finish();
    LasReader r(folder / name);
    const LasHeader& h = r.header();
    EXPECT_EQ(h.version_minor, 4);
    EXPECT_EQ(h.point_format, 7);
    EXPECT_TRUE(h.gps_time_is_adjusted());
    EXPECT_TRUE(h.global_encoding & las_encoding::wkt);
    EXPECT_EQ(r.crs().definition, core::Crs("EPSG:32632").wkt1());
    EXPECT_EQ(h.legacy_point_count, 0u);
    for (const std::uint64_t k : h.by_return) EXPECT_EQ(k, 200u);
    EXPECT_EQ(h.extras.size(), 6u);
    core::Block q;
    q.origin = b.origin;
    ASSERT_EQ(r.read(q, 5000), 3000u);
    EXPECT_TRUE(r.warnings().empty());
    for (std::size_t i = 0; i < b.size(); ++i) {
      ASSERT_NEAR(q.x[i], b.x[i], half_mm);
      ASSERT_NEAR(q.y[i], b.y[i], half_mm);
      ASSERT_NEAR(q.z[i], b.z[i], half_mm);
      ASSERT_NEAR(q.time[i], b.time[i], 3e-7);  // doubles near 1.4e9 s
      ASSERT_NEAR(q.scan_angle[i], b.scan_angle[i], half_angle);
      ASSERT_NEAR(q.range[i], b.range[i], 0.0005 + 1e-4);
      ASSERT_NEAR(q.incidence[i], b.incidence[i], 0.001 * degree + 1e-6);
      ASSERT_NEAR(q.sigma_h[i], b.sigma_h[i], 0.00005 + 1e-8);
      ASSERT_EQ(std::isnan(q.sigma_v[i]), std::isnan(b.sigma_v[i]));
      ASSERT_EQ(std::isnan(q.ground_probability[i]), std::isnan(b.ground_probability[i]));
      if (!std::isnan(b.ground_probability[i])) {
        ASSERT_NEAR(q.ground_probability[i], b.ground_probability[i], 0.00005 + 1e-7);
      }
      ASSERT_NEAR(q.height[i], b.height[i], 0.0005 + 1e-6);
    }
    EXPECT_EQ(q.intensity, b.intensity);
    EXPECT_EQ(q.return_number, b.return_number);
    EXPECT_EQ(q.return_count, b.return_count);
    EXPECT_EQ(q.classification, b.classification);
    EXPECT_EQ(q.flags, b.flags);
    EXPECT_EQ(q.strip, b.strip);
    EXPECT_EQ(q.record, b.record);
    EXPECT_EQ(q.red, b.red);
    EXPECT_EQ(q.green, b.green);
    EXPECT_EQ(q.blue, b.blue);
    EXPECT_EQ(q.user_data, b.user_data);
  }
}

TEST(LasWriter, BytesDependNeitherOnThreadsNorOnBatches) {
  const test::TemporaryFolder folder;
  const core::Block b = sample_block(180000);
  const auto written = [&](const std::string& name, unsigned threads, std::size_t batch) {
    LasWriteOptions o = options();
    o.threads = threads;
    LasWriter w(folder / name, o);
    for (std::size_t at = 0; at < b.size(); at += batch) {
      std::vector<std::uint32_t> rows;
      for (std::size_t i = at; i < std::min(b.size(), at + batch); ++i) rows.push_back(static_cast<std::uint32_t>(i));
      w.write(core::select(b, rows));
    }
    w.finish();
    return test::read_bytes(folder / name);
  };
  const std::string las = written("a.las", 1, b.size()), laz = written("a.laz", 1, b.size());
  EXPECT_EQ(written("b.las", 1, 777), las);
  EXPECT_TRUE(written("b.laz", 1, 7777) == laz);
  EXPECT_TRUE(written("c.laz", 3, b.size()) == laz);
  EXPECT_TRUE(written("d.laz", 0, 60000) == laz);
  EXPECT_LT(laz.size(), las.size());
}

TEST(LasWriter, OnlyWhatTheBlockHasIsWritten) {
  const test::TemporaryFolder folder;
  core::Block b;
  core::resize(b, 3);
  core::add_columns(b, {core::Column::time, core::Column::height});
  LasWriter w(folder / "a.laz", options());
  w.write(b);
  core::Block more = b;
  more.sigma_h.resize(3);
  EXPECT_THROW(w.write(more), core::Error);
  w.finish();
  const LasReader r(folder / "a.laz");
  EXPECT_EQ(r.header().point_format, 6);
  ASSERT_EQ(r.header().extras.size(), 1u);
  EXPECT_EQ(r.header().extras[0].name, "height_above_ground");
  EXPECT_EQ(r.header().extras[0].description, "height above ground, m");
}

TEST(LasWriter, NoPointsIsAFileWithNoPoints) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a.las", "a.laz"}) {
    LasWriter w(folder / name, options());
    w.finish();
    LasReader r(folder / name);
    EXPECT_EQ(r.header().point_count, 0u);
    LasPoints p;
    EXPECT_EQ(r.read(p, 10), 0u);
    EXPECT_TRUE(r.warnings().empty());
  }
}

TEST(LasWriter, WhatDoesNotFitIsRefusedAndLeavesNothing) {
  const test::TemporaryFolder folder;
  const auto refused = [&](auto change, const char* what) {
    core::Block b = sample_block(10);
    LasWriteOptions o = options();
    change(b, o);
    try {
      LasWriter w(folder / "a.laz", o);
      w.write(b);
      w.finish();
      ADD_FAILURE() << what;
    } catch (const core::Error& e) {
      EXPECT_NE(e.text().find(what), std::string::npos) << e.text();
    }
    EXPECT_EQ(test::entries(folder.path()), 0u);
  };
  refused([](core::Block& b, LasWriteOptions&) { b.x[4] = 3e6; }, "point 4: x = 3512000");
  refused([](core::Block& b, LasWriteOptions&) { b.z[5] = std::numeric_limits<double>::quiet_NaN(); }, "point 5: z");
  refused([](core::Block&, LasWriteOptions& o) { o.offset = Eigen::Vector3d::Zero(); }, "does not fit scale");
  refused([](core::Block& b, LasWriteOptions&) { b.return_number[2] = 16; }, "return 16 of 15");
  refused([](core::Block& b, LasWriteOptions&) { b.sigma_h[3] = -1.0f; }, "sigma_h");
  refused([](core::Block&, LasWriteOptions& o) { o.scale.y() = 0.0; }, "scale of y");
  refused([](core::Block&, LasWriteOptions& o) { o.version_minor = 2; }, "no point format 7");
}

TEST(LasWriter, AWriterThatNeverFinishesLeavesNothing) {
  const test::TemporaryFolder folder;
  {
    LasWriter w(folder / "a.laz", options());
    w.write(sample_block(100));
  }
  EXPECT_EQ(test::entries(folder.path()), 0u);
}

TEST(LasWriter, AWriteThatIsCutShortAnywhereLeavesNothingAndIsTheSystemsFault) {
  const test::TemporaryFolder folder;
  const core::Block block = sample_block(20000);
  for (const char* name : {"a.las", "a.laz"}) {
    const auto write = [&] {
      LasWriter writer(folder / name, {});
      writer.write(block);
      writer.finish();
    };
    write();
    const auto whole = std::filesystem::file_size(folder / name);
    std::filesystem::remove(folder / name);
    constexpr unsigned steps = 8;
    for (unsigned s = 0; s < steps; ++s) {
      const test::FileSizeLimit limit(s + 1 == steps ? whole - 1 : whole * s / steps);
      EXPECT_THROW(write(), core::SystemError) << name << s;
      EXPECT_EQ(test::entries(folder.path()), 0u) << name << s;
    }
  }
}

TEST(LasWriter, CoordinatesAreRoundedToTheNearest) {
  const test::TemporaryFolder folder;
  core::Block b;
  core::resize(b, 2);
  b.x = {0.0014, -0.0016};
  LasWriteOptions o;
  o.offset = Eigen::Vector3d::Zero();
  LasWriter w(folder / "a.las", o);
  w.write(b);
  w.finish();
  EXPECT_EQ(test::read_all(folder / "a.las").raw_x, (std::vector<std::int32_t>{1, -2}));
}

TEST(LasWriter, OldFormatsOfABlock) {
  const test::TemporaryFolder folder;
  core::Block b = sample_block(20);
  for (auto& n : b.return_count) n = 7;
  for (auto& n : b.return_number) n = 1;
  for (auto& f : b.flags) f = core::flag::overlap;
  for (auto& c : b.classification) c = 1;
  LasWriteOptions o;
  o.format = 3;
  o.version_minor = 2;
  LasWriter w(folder / "a.laz", o);
  w.write(b);
  w.finish();
  LasReader r(folder / "a.laz");
  EXPECT_EQ(r.header().version_minor, 2);
  core::Block q;
  ASSERT_EQ(r.read(q, 20), 20u);
  EXPECT_EQ(q.flags, b.flags);  // through class 12
  EXPECT_EQ(q.classification, b.classification);
}

TEST(LasWriter, ChunksOfVariableSizeThroughTheStreams) {
  const test::TemporaryFolder folder;
  const std::string file = (folder / "chunks").string();
  std::array<char, 256> message{};
  for (const int format : {3, 7}) {
    LasHeader h = test::sample_header(format);
    las_header_bytes(h, 0, "test");
    const LasPoints p = test::sample_points(h, 1111);
    std::vector<std::uint8_t> records(p.size() * h.record_length), vlr(256), back(records.size());
    encode_las_points(p, 0, p.size(), h, records, "test");
    std::size_t size = 0;
    const auto f = static_cast<std::uint8_t>(format);
    ASSERT_EQ(swath_laz_vlr(f, 0, 0, vlr.data(), vlr.size(), &size, message.data(), message.size()), SWATH_LAZ_OK) << message.data();
    EXPECT_EQ(swath_laz_vlr(f, 0, 0, vlr.data(), 3, &size, message.data(), message.size()), SWATH_LAZ_USAGE);
    test::write_bytes(file, "0123456789");
    swath_laz_writer* w = nullptr;
    ASSERT_EQ(swath_laz_writer_open(file.c_str(), 10, vlr.data(), size, 2, &w, message.data(), message.size()), SWATH_LAZ_OK);
    const std::array<std::uint64_t, 3> counts{1, 1000, 110}, nothing{1, 0, 1};
    std::array<std::uint64_t, 3> offsets{}, bytes{};
    const auto chunks = [&](const auto& n) {
      return swath_laz_writer_write_chunks(w, records.data(), n.data(), 3, offsets.data(), bytes.data(), message.data(), message.size());
    };
    EXPECT_EQ(chunks(nothing), SWATH_LAZ_USAGE);
    EXPECT_EQ(swath_laz_writer_write(w, records.data(), 1, message.data(), message.size()), SWATH_LAZ_USAGE);
    ASSERT_EQ(chunks(counts), SWATH_LAZ_OK) << message.data();
    std::uint64_t end = 0;
    ASSERT_EQ(swath_laz_writer_finish(w, &end, message.data(), message.size()), SWATH_LAZ_OK);
    swath_laz_writer_close(w);
    EXPECT_EQ(offsets[0], 18u);
    EXPECT_EQ(offsets[2], offsets[1] + bytes[1]);
    EXPECT_EQ(end, std::filesystem::file_size(file));
    swath_laz_reader* r = nullptr;
    ASSERT_EQ(
        swath_laz_reader_open(file.c_str(), nullptr, 10, vlr.data(), size, f, h.record_length, 1111, 2, &r, message.data(), message.size()),
        SWATH_LAZ_OK);
    EXPECT_EQ(swath_laz_reader_read(r, back.data(), 1112, message.data(), message.size()), SWATH_LAZ_USAGE);
    EXPECT_EQ(swath_laz_reader_read(r, back.data(), 1111, message.data(), message.size()), SWATH_LAZ_OK);
    EXPECT_TRUE(back == records);
    swath_laz_reader_close(r);
  }
}

TEST(LazStream, AChunkOfManyMegabytesIsReadPieceByPiece) {
  constexpr std::uint64_t points = 400'000;  // 8 MB and more are not decompressed whole
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "large.laz";
  std::array<char, 256> message{};
  for (const int format : {1, 6}) {
    LasHeader h = test::sample_header(format);
    las_header_bytes(h, 0, "test");
    const LasPoints p = test::sample_points(h, 1000);
    std::vector<std::uint8_t> some(p.size() * h.record_length), records, vlr(256);
    encode_las_points(p, 0, p.size(), h, some, "test");
    while (records.size() < (points + 10) * h.record_length) records.insert(records.end(), some.begin(), some.end());
    records.resize((points + 10) * h.record_length);
    std::size_t size = 0;
    const auto f = static_cast<std::uint8_t>(format);
    ASSERT_EQ(swath_laz_vlr(f, 0, 0, vlr.data(), vlr.size(), &size, message.data(), message.size()), SWATH_LAZ_OK);
    test::write_bytes(file, "");
    swath_laz_writer* w = nullptr;
    ASSERT_EQ(swath_laz_writer_open(file.c_str(), 0, vlr.data(), size, 1, &w, message.data(), message.size()), SWATH_LAZ_OK);
    const std::array<std::uint64_t, 3> counts{4, points, 6};
    std::array<std::uint64_t, 3> offsets{}, bytes{};
    ASSERT_EQ(
        swath_laz_writer_write_chunks(w, records.data(), counts.data(), 3, offsets.data(), bytes.data(), message.data(), message.size()),
        SWATH_LAZ_OK)
        << message.data();
    std::uint64_t end = 0;
    ASSERT_EQ(swath_laz_writer_finish(w, &end, message.data(), message.size()), SWATH_LAZ_OK);
    swath_laz_writer_close(w);
    swath_laz_reader* r = nullptr;
    ASSERT_EQ(swath_laz_reader_open(file.c_str(), nullptr, 0, vlr.data(), size, f, h.record_length, points + 10, 2, &r, message.data(),
                                    message.size()),
              SWATH_LAZ_OK);
    std::vector<std::uint8_t> back(records.size());
    for (std::uint64_t at = 0; at < points + 10;) {
      const std::uint64_t n = std::min<std::uint64_t>(77'777, points + 10 - at);
      ASSERT_EQ(swath_laz_reader_read(r, back.data() + at * h.record_length, n, message.data(), message.size()), SWATH_LAZ_OK)
          << message.data();
      at += n;
    }
    EXPECT_TRUE(back == records);
    swath_laz_reader_close(r);
  }
}

}  // namespace
}  // namespace swath::io
