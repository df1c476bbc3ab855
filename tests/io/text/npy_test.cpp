// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/npy.h"

#include <cmath>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

/// A .npy file as NumPy lays it out.
std::string npy(const std::string& dict, const std::string& data, int version = 1) {
  std::string header = dict;
  header.resize((header.size() / 64 + 1) * 64 - 1, ' ');
  header += '\n';
  std::string out = "\x93NUMPY";
  out += static_cast<char>(version);
  out += '\0';
  for (int i = 0; i < (version == 1 ? 2 : 4); ++i) out += static_cast<char>((header.size() >> (8 * i)) & 255);
  return out + header + data;
}
template <class T>
std::string bytes(T v, bool big = false) {
  std::string out(sizeof(T), '\0');
  std::memcpy(out.data(), &v, sizeof(T));
  if (big) std::reverse(out.begin(), out.end());
  return out;
}

class Npy : public ::testing::Test {
 protected:
  std::filesystem::path made(const std::string& content) {
    test::write_bytes(folder_ / "a.npy", content);
    return folder_ / "a.npy";
  }
  std::vector<std::vector<double>> read(const std::string& content, const std::vector<std::string>& names) {
    const auto file = made(content);
    const NpyHeader header = read_npy_header(file);
    std::vector<size_t> fields;
    for (const auto& n : names) fields.push_back(field_of(header, n, file));
    NpyReader reader(file, fields);
    std::vector<std::vector<double>> out;
    reader.read(0, reader.rows(), out);
    return out;
  }
  test::TemporaryFolder folder_;
};
using Columns = std::vector<std::vector<double>>;

TEST_F(Npy, StructuredFieldsOfEveryTypeAndOrder) {
  const std::string dict =
      "{'descr': [('t', '<f8'), ('r', '>f4'), ('u1', '|u1'), ('i1', '|i1'), ('u2', '>u2'), ('i2', '<i2'), ('u4', '<u4'), ('i4', '>i4'), "
      "('u8', '<u8'), ('i8', '<i8'), ('h', '<f2'), ('b', '|b1'), ('s', '<U2')], 'fortran_order': False, 'shape': (1,), }";
  const std::string row = bytes(1.25) + bytes(2.5f, true) + bytes<std::uint8_t>(200) + bytes<std::int8_t>(-7) +
                          bytes<std::uint16_t>(60000, true) + bytes<std::int16_t>(-300) + bytes<std::uint32_t>(4000000000u) +
                          bytes<std::int32_t>(-70000, true) + bytes<std::uint64_t>(1ull << 40) + bytes<std::int64_t>(-(1ll << 40)) +
                          bytes<std::uint16_t>(0xC100) + bytes<std::uint8_t>(1) + std::string(8, 'x');
  for (const int version : {1, 2, 3})
    EXPECT_EQ(read(npy(dict, row, version), {"t", "r", "u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "h", "b"}),
              (Columns{{1.25}, {2.5}, {200}, {-7}, {60000}, {-300}, {4e9}, {-70000}, {1099511627776.}, {-1099511627776.}, {-2.5}, {1}}));
  EXPECT_THROW(read(npy(dict, row), {"s"}), core::Error);
}

TEST_F(Npy, PaddedTypes) {
  const std::string data =
      bytes<std::uint8_t>(3) + std::string(7, '\x7f') + bytes(4.5) + bytes<std::uint8_t>(5) + std::string(7, '\x7f') + bytes(6.5);
  const Columns wanted{{4.5, 6.5}, {3, 5}};
  EXPECT_EQ(read(npy("{'descr': [('a', '|u1'), ('', '|V7'), ('b', '<f8')], 'fortran_order': False, 'shape': (2,)}", data), {"b", "a"}),
            wanted);
  EXPECT_EQ(read(npy("{'descr': {'names': ['b', 'a'], 'formats': ['<f8', 'u1'], 'offsets': [8, 0], 'itemsize': 16}, 'fortran_order': "
                     "False, 'shape': (2,)}",
                     data),
                 {"b", "a"}),
            wanted);
}

TEST_F(Npy, PlainArraysInBothOrders) {
  const auto all = [](std::initializer_list<double> v) {
    std::string out;
    for (const double d : v) out += bytes(d);
    return out;
  };
  const Columns wanted{{3, 6}, {1, 4}};
  EXPECT_EQ(read(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3)}", all({1, 2, 3, 4, 5, 6})), {"3", "1"}), wanted);
  EXPECT_EQ(read(npy("{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3)}", all({1, 4, 2, 5, 3, 6})), {"3", "1"}), wanted);
  EXPECT_EQ(read(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (2,)}", all({1, 2})), {"1"}), (Columns{{1, 2}}));
}

TEST_F(Npy, EveryTruncationIsAnError) {
  const std::string whole = npy("{'descr': [('t', '<f8')], 'fortran_order': False, 'shape': (3,)}", std::string(24, 'a'));
  EXPECT_NO_THROW(read_npy_header(made(whole)));
  for (size_t n = 0; n < whole.size(); ++n) EXPECT_THROW(read_npy_header(made(whole.substr(0, n))), core::Error) << n;
  try {
    read_npy_header(made(whole.substr(0, whole.size() - 5)));
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.where().find("byte " + std::to_string(whole.size() - 5)), std::string::npos) << e.text();
  }
}

TEST_F(Npy, WhatCannotBeReadIsRefused) {
  for (const char* dict :
       {"{'descr': '|O', 'fortran_order': False, 'shape': (1,)}", "{'descr': [('a', '|O')], 'fortran_order': False, 'shape': (1,)}",
        "{'descr': [('a', '<f8', (3,))], 'fortran_order': False, 'shape': (1,)}",
        "{'descr': [('a', [('b', '<f8')])], 'fortran_order': False, 'shape': (1,)}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 1, 1)}", "{'descr': '<f8', 'fortran_order': False, 'shape': ()}",
        "{'descr': '<f8', 'shape': (1,)}", "{'descr': '<f8', 'fortran_order': False",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (-1,)}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (4611686018427387904,)}", "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[["})
    EXPECT_THROW(read_npy_header(made(npy(dict, std::string(64, 'a')))), core::Error) << dict;
  EXPECT_THROW(read_npy_header(made("PK\x03\x04 no numpy file here")), core::Error);
  EXPECT_THROW(read_npy_header(made(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1,)}", std::string(8, 'a'), 9))), core::Error);
}

TEST_F(Npy, AMissingFieldIsNamedWithTheNearest) {
  try {
    read(npy("{'descr': [('range', '<f8'), ('t', '<f8')], 'fortran_order': False, 'shape': (1,)}", std::string(16, 'a')), {"rnge"});
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("range, t"), std::string::npos);
    EXPECT_NE(e.hint().find("'range'"), std::string::npos);
  }
}

TEST_F(Npy, WrittenArraysReadBack) {
  const std::vector<double> t{1.5, std::nan(""), -1e300}, n{0, 255, 17}, k{-2147483648., 5, 2147483647.};
  {
    NpyWriter writer(folder_ / "w.npy", {{"t", "f8"}, {"n", "u1"}, {"k", "i4"}});
    writer.append({t.data(), n.data(), k.data()}, 2);
    writer.append({t.data() + 2, n.data() + 2, k.data() + 2}, 1);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "w.npy"));
    writer.commit();
  }
  NpyReader reader(folder_ / "w.npy", {0, 1, 2});
  EXPECT_EQ(reader.header().data_begin % 64, 0u);
  Columns back;
  reader.read(1, 2, back);
  EXPECT_TRUE(std::isnan(back[0][0]));
  EXPECT_EQ(back[0][1], -1e300);
  EXPECT_EQ(back[1], (std::vector<double>{255, 17}));
  EXPECT_EQ(back[2], (std::vector<double>{5, 2147483647.}));
  const double wrong = 256;
  NpyWriter bad(folder_ / "x.npy", {{"n", "u1"}});
  EXPECT_THROW(bad.append({&wrong}, 1), core::Error);
  EXPECT_THROW(NpyWriter(folder_ / "y.npy", {{"n", "O"}}), core::Error);
}

TEST_F(Npy, FieldsOutsideTheRecordAndEndlessHeadersAreRefused) {
  const auto placed = [](const std::string& offsets) {
    return npy("{'descr': {'names': ['a', 'b'], 'formats': ['<f8', '<f8'], 'offsets': [" + offsets +
                   "]}, 'fortran_order': False, 'shape': (2,), }",
               std::string(32, '\0'));
  };
  EXPECT_EQ(read_npy_header(made(placed("8, 0"))).row_stride, 16u);
  EXPECT_THROW(read_npy_header(made(placed("-800000, 8"))), core::Error);
  EXPECT_THROW(read_npy_header(made(placed("0, -8"))), core::Error);
  EXPECT_THROW(read_npy_header(made(placed("0, 9223372036854775807"))), core::Error);
  EXPECT_THROW(read_npy_header(made(npy(std::string(70000, ' ') + "{}", "", 2))), core::Error);
}

TEST_F(Npy, LongRecordsAreReadInParts) {
  constexpr size_t rows = 40, length = 1000000;
  std::string data(rows * length, '\0');
  for (size_t i = 0; i < rows; ++i) data[i * length] = static_cast<char>(i);
  const std::string dict = "{'descr': [('n', '|u1'), ('', '|V999999')], 'fortran_order': False, 'shape': (40,), }";
  const Columns back = read(npy(dict, data), {"n"});
  for (size_t i = 0; i < rows; ++i) EXPECT_EQ(back[0][i], static_cast<double>(i));
  EXPECT_THROW(read_npy_header(made(npy("{'descr': [('n', '|u1'), ('', '|V1048576')], 'fortran_order': False, 'shape': (1,), }",
                                        std::string(1048577, '\0')))),
               core::Error);
}

TEST(NpyReference, TinySurvey) {
  SWATH_SHARED_OR_SKIP(file, "data/tiny_survey/laser.npy");
  const NpyHeader header = read_npy_header(file);
  EXPECT_EQ(header.rows, 108430u);
  EXPECT_EQ(header.row_stride, 30u);
  NpyReader reader(file, {field_of(header, "range", file), field_of(header, "nr", file)});
  Columns first;
  reader.read(0, 2, first);
  EXPECT_EQ(first, (Columns{{500.855, 500.495}, {1, 1}}));
}

}  // namespace
}  // namespace swath::io
