// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/las_reader.h"

#include <algorithm>
#include <cstring>
#include <fstream>

#include "core/error.h"
#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(LasReader, EveryFormatComesBackFieldByField) {
  const test::TemporaryFolder folder;
  for (int format = 0; format <= 10; ++format)
    for (const char* name : {"a.las", "a.laz"})
      for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{2000}}) {
        const LasHeader h = test::sample_header(format, -1, format % 2 == 0);
        const LasPoints p = test::sample_points(h, n, static_cast<unsigned>(format) + 1);
        test::write_sample(folder / name, h, p);
        LasReader r(folder / name);
        EXPECT_EQ(r.header().compressed, std::string(name) == "a.laz");
        EXPECT_EQ(r.header().point_count, n);
        LasPoints q;
        EXPECT_EQ(r.read(q, n + 5), n);
        EXPECT_TRUE(q == p) << name << " format " << format << " points " << n;
        EXPECT_EQ(r.read(q, 5), 0u);
        EXPECT_EQ(q.size(), 0u);
        EXPECT_TRUE(r.warnings().empty()) << r.warnings()[0];
      }
}

TEST(LasReader, ManyChunksInBatchesOfAnySize) {
  const test::TemporaryFolder folder;
  for (const int format : {1, 6, 10}) {
    const std::size_t n = format == 6 ? (1u << 20) + 1 : 150001;  // one file of many chunks, two whose last chunk holds one point
    const LasHeader h = test::sample_header(format);
    const LasPoints p = test::sample_points(h, n);
    for (const char* name : {"a.las", "a.laz"}) {
      test::write_sample(folder / name, h, p);
      LasReader r(folder / name);
      LasPoints q;
      std::size_t at = 0, same = 0;
      for (const std::size_t batch : {std::size_t{1}, std::size_t{49999}, std::size_t{300001}, n}) {
        const std::size_t got = r.read(q, batch);
        for (std::size_t i = 0; i < got; ++i)
          same += q.raw_x[i] == p.raw_x[at + i] && q.raw_z[i] == p.raw_z[at + i] && q.gps_time[i] == p.gps_time[at + i] &&
                  q.flags[i] == p.flags[at + i] && q.user_data[i] == p.user_data[at + i];
        at += got;
      }
      EXPECT_EQ(at, n);
      EXPECT_EQ(same, n) << name << " format " << format;
      EXPECT_EQ(r.position(), n);
    }
    EXPECT_TRUE(test::read_all(folder / "a.laz", 1) == p) << format;
  }
}

TEST(LasReader, DamagedTimesAreAnErrorAndNoEndlessRecursion) {
  // A layer of GPS times that is all ones means a switch of sequence after another: hundreds of thousands before its bytes are used up.
  const test::TemporaryFolder folder;
  const LasHeader h = test::sample_header(6);
  constexpr std::size_t n = 20000;
  const LasPoints p = test::sample_points(h, n);
  test::write_sample(folder / "a.laz", h, p);
  ASSERT_TRUE(test::read_all(folder / "a.laz") == p);
  std::string bytes = test::read_bytes(folder / "a.laz");
  const auto number = [&](std::size_t at) {
    std::uint32_t v = 0;
    std::memcpy(&v, bytes.data() + at, sizeof v);
    return std::size_t{v};
  };
  // A chunk: the first point whole, the count, the sizes of the nine layers, the layers, GPS times last.
  constexpr std::size_t offset_of_points = 96, point = 30, layers = 9;
  const std::size_t sizes = number(offset_of_points) + sizeof(std::uint64_t) + point + sizeof(std::uint32_t);
  std::size_t at = sizes + layers * sizeof(std::uint32_t);
  for (std::size_t k = 0; k + 1 < layers; ++k) at += number(sizes + k * sizeof(std::uint32_t));
  const std::size_t size = number(sizes + (layers - 1) * sizeof(std::uint32_t));
  ASSERT_LT(at + size, bytes.size());
  ASSERT_GT(size, 10000u);
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), size, '\xff');
  std::ofstream(folder / "a.laz", std::ios::binary) << bytes;
  EXPECT_THROW(test::read_all(folder / "a.laz"), core::Error);
}

/// Cut anywhere, the file is refused or, where the last bytes say nothing, read whole: never something else.
void every_cut_is_an_error(const std::string& ending, int format) {
  const test::TemporaryFolder folder;
  const LasHeader h = test::sample_header(format, -1, true);
  const LasPoints p = test::sample_points(h, 400);
  const std::string name = "cut." + ending;
  test::write_sample(folder / name, h, p);
  const std::string whole = test::read_bytes(folder / name);
  // The arithmetic coder of LASzip ends with bytes that its decoder need not look at.
  const std::size_t padding = ending == "laz" ? 4 : 0;
  std::size_t refused = 0;
  const std::size_t step = 1 + whole.size() / 1500;
  for (std::size_t size = whole.size(); size > 0;) {
    size -= std::min(size, size < 400 || size + 200 > whole.size() ? 1 : step);
    std::filesystem::resize_file(folder / name, size);
    try {
      const LasPoints q = test::read_all(folder / name);
      EXPECT_GE(size + padding, whole.size()) << "a file cut at " << size << " of " << whole.size() << " was read";
      EXPECT_TRUE(q == p);
    } catch (const core::Error& e) {
      EXPECT_NE(e.where().find(name), std::string::npos) << e.text();
      EXPECT_FALSE(e.hint().empty());
      ++refused;
    }
  }
  EXPECT_GT(refused, 500u);
}
TEST(LasReader, EveryCutOfALasFileIsAnError) { every_cut_is_an_error("las", 3); }
TEST(LasReader, EveryCutOfALasFile14IsAnError) { every_cut_is_an_error("las", 8); }
TEST(LasReader, EveryCutOfALazFileIsAnError) { every_cut_is_an_error("laz", 3); }
TEST(LasReader, EveryCutOfALayeredLazFileIsAnError) { every_cut_is_an_error("laz", 10); }

TEST(LasReader, DamagedBytesAreAnErrorOrOtherPointsNeverACrash) {
  const test::TemporaryFolder folder;
  std::mt19937 random(3);
  for (const int format : {1, 5, 6, 10}) {
    const LasHeader h = test::sample_header(format, -1, true);
    const LasPoints p = test::sample_points(h, 300);
    test::write_sample(folder / "a.laz", h, p);
    const std::string whole = test::read_bytes(folder / "a.laz");
    std::fstream file(folder / "a.laz", std::ios::in | std::ios::out | std::ios::binary);
    std::size_t refused = 0;
    for (int i = 0; i < 300; ++i) {
      std::string bytes = whole;
      for (int k = 0; k <= i % 3; ++k) bytes[random() % (i % 2 == 0 ? 700 : bytes.size())] = static_cast<char>(random());
      file.seekp(0);
      file << bytes << std::flush;
      try {
        LasReader r(folder / "a.laz", 1);
        LasPoints q;
        while (r.read(q, 100) > 0) {
        }
      } catch (const core::Error&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 0u) << format;
  }
}

TEST(LasReader, ACountThatTheChunksDoNotHoldIsAnError) {
  const test::TemporaryFolder folder;
  for (const int format : {1, 6}) {
    const LasHeader h = test::sample_header(format, 4);
    test::write_sample(folder / "a.laz", h, test::sample_points(h, 100));
    for (const std::uint64_t lie : {std::uint64_t{60000}, std::uint64_t{1} << 40, std::uint64_t{99}, std::uint64_t{101}}) {
      if (format == 1 && lie == 99) continue;  // a pointwise chunk does not say where it ends
      std::string bytes = test::read_bytes(folder / "a.laz");
      std::memcpy(&bytes[247], &lie, 8);
      std::memset(&bytes[107], 0, 4);
      test::write_bytes(folder / "b.laz", bytes);
      EXPECT_THROW(test::read_all(folder / "b.laz"), core::Error) << format << " " << lie;
    }
  }
}

TEST(LasReader, AHeaderThatLeavesChunksOutIsAnError) {
  const test::TemporaryFolder folder;
  for (const int format : {1, 6}) {
    const LasHeader h = test::sample_header(format, 4);
    test::write_sample(folder / "a.laz", h, test::sample_points(h, 120000));  // three chunks
    for (const std::uint64_t lie : {std::uint64_t{0}, std::uint64_t{50000}, std::uint64_t{100000}}) {
      std::string bytes = test::read_bytes(folder / "a.laz");
      std::memcpy(&bytes[247], &lie, 8);
      std::memset(&bytes[107], 0, 4);
      test::write_bytes(folder / "b.laz", bytes);
      EXPECT_THROW(test::read_all(folder / "b.laz"), core::Error) << format << " " << lie;
    }
    test::write_sample(folder / "none.laz", h, test::sample_points(h, 0));
    EXPECT_EQ(test::read_all(folder / "none.laz").size(), 0u);
    test::write_sample(folder / "whole.laz", h, test::sample_points(h, 100000));  // the last chunk is full
    EXPECT_EQ(test::read_all(folder / "whole.laz").size(), 100000u);
  }
}

TEST(LasReader, ChunksThatAKilledWriterLeftWithoutCountAndTableAreAnError) {
  const test::TemporaryFolder folder;
  for (const int format : {1, 6}) {
    const LasHeader h = test::sample_header(format, 4);
    test::write_sample(folder / "a.laz", h, test::sample_points(h, 100));
    const std::string whole = test::read_bytes(folder / "a.laz");
    const auto number = [](const std::string& bytes, std::size_t at, auto n) {
      std::memcpy(&n, &bytes[at], sizeof n);
      return n;
    };
    const auto start = number(whole, 96, std::uint32_t{0});
    const auto table = number(whole, start, std::uint64_t{0});
    ASSERT_GT(table, start + 8u);
    std::string killed = whole.substr(0, table);
    std::memset(&killed[247], 0, 8), std::memset(&killed[107], 0, 4);  // counts of points
    for (const std::uint64_t offset : {~std::uint64_t{0}, std::uint64_t{0}, std::uint64_t{start}}) {
      std::memcpy(&killed[start], &offset, 8);
      test::write_bytes(folder / "b.laz", killed);
      try {
        test::read_all(folder / "b.laz");
        ADD_FAILURE() << format << " " << offset << " was read";
      } catch (const core::Error& e) {
        EXPECT_NE(e.text().find("the header says 0 points"), std::string::npos) << e.text();
      }
    }
    // Nothing was written before it was killed; an extended record behind it is not a chunk.
    std::string none = killed.substr(0, start + 8);
    test::write_bytes(folder / "none.laz", none);
    EXPECT_EQ(test::read_all(folder / "none.laz").size(), 0u) << format;
    const std::uint64_t at = none.size(), length = 400;
    const std::uint32_t records = 1;
    std::memcpy(&none[235], &at, 8), std::memcpy(&none[243], &records, 4);
    std::string record(60 + length, '\0');
    std::memcpy(&record[2], "tests", 5);
    std::memcpy(&record[20], &length, 8);
    test::write_bytes(folder / "none.laz", none + record);
    EXPECT_EQ(test::read_all(folder / "none.laz").size(), 0u) << format;
  }
}

TEST(LasReader, PointsOutsideTheStatedBoundsAreAWarning) {
  const test::TemporaryFolder folder;
  const LasHeader h = test::sample_header(6);
  test::write_sample(folder / "a.las", h, test::sample_points(h, 100));
  std::string bytes = test::read_bytes(folder / "a.las");
  const double low = 1e9;
  std::memcpy(&bytes[187], &low, 8);
  test::write_bytes(folder / "a.las", bytes);
  LasReader r(folder / "a.las");
  EXPECT_TRUE(r.warnings().empty());
  LasPoints p;
  r.read(p, 100);
  ASSERT_EQ(r.warnings().size(), 1u);
  EXPECT_NE(r.warnings()[0].find("100 of 100 points (100 %) lie outside"), std::string::npos);
}

TEST(LasReader, ACompressedReferenceFileEqualsItsTwin) {
  SWATH_SHARED_OR_SKIP(data, "data/isprs");
  std::size_t twins = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data)) {
    if (entry.path().extension() != ".laz") continue;
    std::filesystem::path twin = entry.path();
    const LasPoints p = test::read_all(twin.replace_extension(".las"));
    EXPECT_GT(p.size(), 5000u);
    EXPECT_TRUE(test::read_all(entry.path()) == p) << entry.path();
    ++twins;
  }
  EXPECT_EQ(twins, 7u);
}

TEST(LasReader, AutzenEqualsItsTwinAndComesOutAgain) {
  SWATH_SHARED_OR_SKIP(data, "data/autzen");
  const LasPoints p = test::read_all(data / "autzen_trim.las");
  EXPECT_EQ(p.size(), 110000u);
  EXPECT_TRUE(test::read_all(data / "autzen_trim.laz") == p);
  const test::TemporaryFolder folder;
  for (const char* name : {"a.las", "a.laz"}) {
    test::write_sample(folder / name, LasReader(data / "autzen_trim.las").header(), p);
    EXPECT_TRUE(test::read_all(folder / name) == p) << name;
  }
}

TEST(LasReader, ColumnsThatNobodyUsesAreLeftOutAndTheOthersAreAsInTheFile) {
  const test::TemporaryFolder folder;
  using core::Column;
  const core::ColumnSet unused{Column::time,
                               Column::intensity,
                               Column::scan_angle,
                               Column::user_data,
                               Column::red,
                               Column::green,
                               Column::blue,
                               Column::range,
                               Column::incidence,
                               Column::sigma_h,
                               Column::sigma_v,
                               Column::height,
                               Column::ground_probability,
                               Column::source};
  for (const int format : {3, 6, 7, 8, 10}) {
    LasHeader h = test::sample_header(format, 4, true);
    h.extras.push_back(test::extra_field("sigma_v", 9));
    const LasPoints p = test::sample_points(h, 120000);
    test::write_sample(folder / "a.laz", h, p);
    LasReader whole(folder / "a.laz"), part(folder / "a.laz", 1, {{}, unused});
    core::Block a, b;
    std::size_t rows = 0;
    while (whole.read(a, 50000, {.keep_unknown = true}) > 0) {
      ASSERT_EQ(part.read(b, 50000, {.keep_unknown = true}), a.size());
      EXPECT_EQ(a.x, b.x);
      EXPECT_EQ(a.z, b.z);
      EXPECT_EQ(a.return_number, b.return_number);
      EXPECT_EQ(a.classification, b.classification);
      EXPECT_EQ(a.flags, b.flags);
      EXPECT_EQ(a.strip, b.strip);
      EXPECT_EQ(a.record, b.record);
      EXPECT_EQ(b.intensity.empty(), format != 3) << "older formats are one stream";
      EXPECT_EQ(b.sigma_v.empty(), format != 3);
      EXPECT_FALSE(a.sigma_v.empty());
      if (format >= 6) {
        EXPECT_TRUE(std::all_of(b.time.begin(), b.time.end(), [](double t) { return t == 0.0; }));
      }
      rows += a.size();
    }
    EXPECT_EQ(rows, 120000u);
    LasReader kept(folder / "a.laz", 1, {{}, unused - core::ColumnSet{Column::source}});
    kept.read(b, 10, {.keep_unknown = true}, 1);
    EXPECT_FALSE(b.intensity.empty()) << "a record that is kept is whole";
  }
}

}  // namespace
}  // namespace swath::io
