// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/output_file.h"

#include <sys/resource.h>

#include <thread>

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

TEST(OutputFile, ALibrarysWordsForAFullDiskAreKnown) {
  const test::TemporaryFolder folder;
  for (const char* what : {"No space left on device", "failed to write whole buffer: No space left on device (os error 28)"}) {
    try {
      throw_write_error(what, folder / "a.tif");
      FAIL();
    } catch (const core::SystemError& e) {
      EXPECT_NE(e.hint().find("disk is full"), std::string::npos);
    }
  }
  EXPECT_THROW(throw_write_error("TIFFAppendToStrip: write error", folder / "a.tif"), core::SystemError);
}

TEST(OutputFile, AFileSizeLimitIsNamedOnlyWhereItIsReached) {
  const test::TemporaryFolder folder;
  const OutputFile out(folder / "a.tif");
  test::write_bytes(out.temporary(), std::string(100000, 'x'));
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto hint_at = [&](rlim_t bytes) {
    struct rlimit limited = before;
    limited.rlim_cur = bytes;
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &limited), 0);
    std::string hint;
    try {
      throw_write_error("TIFFAppendToStrip: write error", folder / "a.tif");
    } catch (const core::SystemError& e) {
      hint = e.hint();
    }
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
    return hint;
  };
  EXPECT_NE(hint_at(100000).find("file size limit"), std::string::npos);
  EXPECT_EQ(hint_at(1000000).find("file size limit"), std::string::npos);
}

TEST(FinishedFiles, AreThoseOfThisThreadAndTheInnermostScope) {
  const test::TemporaryFolder folder;
  std::vector<std::filesystem::path> seen;
  const FinishedFiles outer([&](const std::filesystem::path& file) { seen.push_back(file); });
  write_text_file(folder / "a", "a");
  {
    const FinishedFiles inner;
    write_text_file(folder / "b", "b");
    std::thread([&] { write_text_file(folder / "c", "c"); }).join();
    EXPECT_EQ(inner.files(), std::vector<std::filesystem::path>{folder / "b"});
  }
  { const OutputFile never(folder / "d"); }
  write_text_file(folder / "e", "e");
  EXPECT_EQ(outer.files(), (std::vector<std::filesystem::path>{folder / "a", folder / "e"}));
  EXPECT_EQ(seen, outer.files());
}

}  // namespace
}  // namespace swath::io
