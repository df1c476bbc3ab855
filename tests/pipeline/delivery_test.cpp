// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/delivery.h"

#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <set>

#include "core/error.h"
#include "io/text/output_file.h"
#include "tests/world/support.h"

namespace {

std::set<ino_t> flushed;

}  // namespace

/// In place of the C library's: which files were flushed to the disk.
extern "C" int fsync(int fd) {
  struct stat info {};
  if (::fstat(fd, &info) == 0) flushed.insert(info.st_ino);
  return static_cast<int>(::syscall(SYS_fsync, fd));
}

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

class Delivery : public ::testing::TestWithParam<bool> {
 protected:
  void make(const fs::path& name, const std::string& bytes) { test::write_bytes(folder_ / name, bytes); }
  std::string delivered(const fs::path& name) const { return test::read_bytes(folder_ / "out" / name); }
  test::TemporaryFolder folder_;
};

TEST_P(Delivery, EveryFileComesToItsPlaceAndCanComeAgain) {
  make("made/points/a.laz", "points");
  make("made/relief.png", "picture");
  make("made/points/.part-7-a.laz", "half");
  for (int times = 0; times < 2; ++times) deliver({folder_ / "made"}, folder_ / "out", GetParam());
  EXPECT_EQ(delivered("points/a.laz"), "points");
  EXPECT_EQ(delivered("relief.png"), "picture");
  int files = 0;
  for (const auto& e : fs::recursive_directory_iterator(folder_ / "out")) files += e.is_regular_file();
  EXPECT_EQ(files, 2) << "nothing temporary goes along or stays";
}

TEST_P(Delivery, TilesThatAreNoLongerListedGo) {
  make("out/points/tiles.json", "[\"old.laz\", \"a.laz\"]");
  make("out/points/old.laz", "old");
  make("out/points/a.laz", "older");
  make("out/points/mine.txt", "a file of the user's");
  make("made/points/tiles.json", "[\"a.laz\"]");
  make("made/points/a.laz", "new");
  deliver({folder_ / "made"}, folder_ / "out", GetParam());
  EXPECT_FALSE(fs::exists(folder_ / "out/points/old.laz"));
  EXPECT_EQ(delivered("points/a.laz"), "new");
  EXPECT_EQ(delivered("points/mine.txt"), "a file of the user's");
}

TEST_P(Delivery, ATemporaryFileOfAKilledDeliveryIsWrittenOver) {
  make("made/relief.png", "picture");
  make("out/.part-relief.png", "half a pict");
  deliver({folder_ / "made"}, folder_ / "out", GetParam());
  EXPECT_EQ(delivered("relief.png"), "picture");
  EXPECT_FALSE(fs::exists(folder_ / "out/.part-relief.png"));
}

TEST_P(Delivery, OnlyWhatIsDeliveredIsFlushed) {
  const auto is_flushed = [&](const fs::path& name) {
    struct stat info {};
    EXPECT_EQ(::stat((folder_ / name).c_str(), &info), 0);
    return flushed.contains(info.st_ino);
  };
  flushed.clear();
  {
    const io::UnflushedFiles work;
    io::write_text_file(folder_ / "made/points/a.laz", "points");
  }
  EXPECT_FALSE(is_flushed("made/points/a.laz"));
  deliver({folder_ / "made"}, folder_ / "out", GetParam());
  EXPECT_TRUE(is_flushed("out/points/a.laz"));
  EXPECT_TRUE(is_flushed("out/points"));
  io::write_text_file(folder_ / "own.json", "{}");
  EXPECT_TRUE(is_flushed("own.json"));
}

INSTANTIATE_TEST_SUITE_P(Keep, Delivery, ::testing::Bool());

TEST(DeliveryCopies, WhatIsKeptIsApartFromWhatIsDelivered) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "made/a", "a");
  deliver({folder / "made"}, folder / "out", true);
  EXPECT_FALSE(fs::equivalent(folder / "made/a", folder / "out/a"));
}

TEST(Discard, LeavesNothingUnderEitherName) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "work/a/b", "b");
  test::write_bytes(folder / "gone/rest", "of a removal that was cut short");
  discard(folder / "work", folder / "gone");
  EXPECT_EQ(test::entries(folder.path()), 0u);
  discard(folder / "work", folder / "gone");
  EXPECT_EQ(test::entries(folder.path()), 0u);
}

TEST(DeliveryCheck, AFolderUnderAProductsNameIsFoundBeforeAnythingIsTouched) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "first/a", "a");
  test::write_bytes(folder / "second/b", "b");
  fs::create_directories(folder / "out/b");
  EXPECT_THROW(deliver({folder / "first", folder / "second"}, folder / "out", false), core::SystemError);
  EXPECT_FALSE(fs::exists(folder / "out/a"));
}

TEST(DeliveryCheck, WhatItWouldWriteAndRemoveIsAskedFor) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "out/points/tiles.json", "[\"old.laz\"]");
  test::write_bytes(folder / "out/points/old.laz", "old");
  test::write_bytes(folder / "made/points/tiles.json", "[\"a.laz\"]");
  test::write_bytes(folder / "made/points/a.laz", "new");
  std::vector<std::string> asked;
  const Allowed note = [&](const fs::path& file) { asked.push_back(file.filename().string()); };
  deliver({folder / "made"}, folder / "out", false, note);
  EXPECT_EQ(asked, (std::vector<std::string>{"a.laz", "tiles.json", "old.laz"}));
  const Allowed refuse = [&](const fs::path&) { throw core::SystemError("an input"); };
  test::write_bytes(folder / "made/points/a.laz", "newer");
  EXPECT_THROW(deliver({folder / "made"}, folder / "out", false, refuse), core::SystemError);
}

TEST(DeliveryCheck, WhatIsNotThereAfterItIsAnError) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "out/a", "abc");
  EXPECT_NO_THROW(expect_delivered(folder / "out/a", 3));
  EXPECT_THROW(expect_delivered(folder / "out/a", 4), core::SystemError);
  EXPECT_THROW(expect_delivered(folder / "out/b", 3), core::SystemError);
}

}  // namespace
}  // namespace swath::pipeline
