// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/binary_file.h"

#include <sys/stat.h>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(BinaryFile, ReadsAtABytePlace) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.bin", "0123456789");
  const BinaryFile file(folder / "a.bin");
  EXPECT_EQ(file.size(), 10u);
  char got[4] = {};
  file.read(3, got, 4);
  EXPECT_EQ(std::string(got, 4), "3456");
  EXPECT_EQ(file.read_some(8, got, 4), 2u);
}

TEST(BinaryFile, TheEndIsNamedByItsByte) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.bin", "0123456789");
  const BinaryFile file(folder / "a.bin");
  char got[8];
  try {
    file.read(5, got, 8);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_EQ(e.where(), (folder / "a.bin").string() + ": byte 10");
  }
}

TEST(BinaryFile, FoldersAndAbsentFilesAreErrors) {
  const test::TemporaryFolder folder;
  const auto hint = [&] {
    try {
      const BinaryFile file(folder.path());
    } catch (const core::Error& e) {
      return e.hint();
    }
    return std::string();
  };
  EXPECT_NE(hint().find("swath init"), std::string::npos) << hint();
  test::write_bytes(folder / "survey.toml", "");
  EXPECT_EQ(hint(), "name its survey: " + (folder / "survey.toml").string());
  EXPECT_THROW(BinaryFile(folder / "none.bin"), core::Error);
}

TEST(BinaryFile, ByteOrders) {
  const unsigned char bytes[4] = {1, 2, 3, 4};
  EXPECT_EQ(load<std::uint32_t>(bytes), 0x04030201u);
  EXPECT_EQ(load<std::uint32_t>(bytes, true), 0x01020304u);
  unsigned char out[8];
  store(out, 1.5);
  EXPECT_EQ(load<double>(out), 1.5);
}

TEST(BinaryAppender, AppendsAndRewrites) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.bin", "");
  BinaryAppender out(folder / "a.bin", folder / "a.bin");
  out.append("abc", 3);
  out.append("def", 3);
  out.rewrite(1, "X", 1);
  out.close();
  EXPECT_EQ(test::read_bytes(folder / "a.bin"), "aXcdef");
  EXPECT_THROW(BinaryAppender(folder / "none", folder / "none"), core::Error);
}

TEST(BinaryFile, APipeIsRefusedAndNotWaitedFor) {
  const test::TemporaryFolder folder;
  const auto pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(BinaryFile{pipe}, core::Error);
}

}  // namespace
}  // namespace swath::io
