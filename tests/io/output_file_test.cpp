// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/output_file.h"

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(OutputFile, AppearsWholeOrNotAtAll) {
  const test::TemporaryFolder folder;
  write_text_file(folder / "a.txt", "first");
  {
    OutputFile out(folder / "a.txt");
    test::write_bytes(out.temporary(), "half");
    EXPECT_EQ(test::read_bytes(folder / "a.txt"), "first");
  }
  EXPECT_EQ(test::read_bytes(folder / "a.txt"), "first");
  EXPECT_EQ(test::entries(folder.path()), 1u);
  write_text_file(folder / "a.txt", "second");
  EXPECT_EQ(test::read_bytes(folder / "a.txt"), "second");
}

TEST(OutputFile, MakesTheFolderAndRefusesWhatCannotBe) {
  const test::TemporaryFolder folder;
  write_text_file(folder / "new/deep/a.txt", "x");
  EXPECT_TRUE(std::filesystem::exists(folder / "new/deep/a.txt"));
  EXPECT_THROW(write_text_file(folder / "new/deep/a.txt/b", "x"), core::Error);
}

TEST(OutputFile, AFullDiskIsNamedWithWhatToDo) {
  try {
    throw_system_error("cannot write", "out.las", ENOSPC);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.text().find("disk is full"), std::string::npos);
    EXPECT_EQ(e.where(), "out.las");
  }
}

}  // namespace
}  // namespace swath::io
