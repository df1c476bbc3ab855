// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/work_folder.h"

#include <sys/file.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <functional>

#include "core/error.h"
#include "pipeline/work/piece_record.h"
#include "tests/world/support.h"

namespace {

std::function<void()> at_flock;

}  // namespace

/// In place of the C library's: something may happen between the opening of the lock's file and this call.
extern "C" int flock(int fd, int operation) noexcept {
  if (at_flock) at_flock();
  return static_cast<int>(::syscall(SYS_flock, fd, operation));
}

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
const std::string stage_name = "03-filters.ground-0123456789abcdef";

TEST(WorkFolder, WhatARunMakesIsOurs) {
  const test::TemporaryFolder folder;
  EXPECT_NO_THROW(expect_own(folder / "none"));
  test::write_bytes(folder / (".swath/" + stage_name + "/0_0.cols"), "x");
  test::write_bytes(folder / ".swath/lock", "");
  fs::create_directories(folder / ".swath/discarded");
  EXPECT_NO_THROW(expect_own(folder / ".swath"));
}

TEST(WorkFolder, WhatIsNotOursIsRefused) {
  const test::TemporaryFolder folder;
  for (const char* name : {"notes.txt", "00-photos", "lock.d/x", "03-filters.ground-0123456789abcdeg/x"}) {
    test::write_bytes(folder / "mine" / name, "mine");
    EXPECT_THROW(expect_own(folder / "mine"), core::Error) << name;
    fs::remove_all(folder / "mine");
  }
  fs::create_directories(folder / "elsewhere");
  fs::create_directory_symlink(folder / "elsewhere", folder / "link");
  EXPECT_THROW(expect_own(folder / "link"), core::Error);
  fs::create_directories(folder / "work");
  fs::create_directory_symlink(folder / "elsewhere", folder / "work" / stage_name);
  EXPECT_THROW(expect_own(folder / "work"), core::Error);
  test::write_bytes(folder / "file", "");
  EXPECT_THROW(expect_own(folder / "file"), core::Error);
}

TEST(WorkFolder, OneRunAtATimeAndThatItsFolderWentIsSeen) {
  const test::TemporaryFolder folder;
  const fs::path work = folder / "out/.swath";
  fs::create_directories(work);
  const WorkLock lock(work);
  EXPECT_THROW(WorkLock{work}, core::Error);
  EXPECT_NO_THROW(lock.expect_there());
  fs::remove_all(folder / "out");
  EXPECT_THROW(lock.expect_there(), core::SystemError);
  test::write_bytes(work / "lock", "");
  EXPECT_THROW(lock.expect_there(), core::SystemError) << "another's";
}

TEST(WorkFolder, ALockOnAFileThatIsNoLongerThereIsNone) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "work");
  at_flock = [&] {  // the run that had the lock ends, and another one begins
    fs::remove(folder / "work/lock");
    test::write_bytes(folder / "work/lock", "");
  };
  EXPECT_THROW(WorkLock{folder / "work"}, core::Error);
  at_flock = [&] { fs::remove_all(folder / "work"); };
  EXPECT_THROW(WorkLock{folder / "work"}, core::Error);
  at_flock = {};
  fs::create_directories(folder / "work");
  EXPECT_TRUE(WorkLock(folder / "work").is_there());
}

TEST(WorkFolder, ALockThatIsALinkIsNotFollowed) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "work");
  fs::create_symlink(folder / "mine", folder / "work/lock");
  EXPECT_THROW(WorkLock{folder / "work"}, core::SystemError);
  EXPECT_FALSE(fs::exists(folder / "mine"));
}

class Work : public ::testing::Test {
 protected:
  Work() {
    const fs::path strip = stage_ / "strip_0001";
    test::write_bytes(strip / "0_0.pts", "points");
    write_record(strip / "strip.json", {piece_files(strip, {strip / "0_0.pts"}), {}});
    for (const char* tile : {"a", "b"}) {
      const fs::path cols = stage_ / (tile + std::string(".cols")), laz = stage_ / "products/points" / (tile + std::string(".laz"));
      test::write_bytes(cols, std::string("columns of ") + tile);
      test::write_bytes(laz, std::string("points of ") + tile);
      write_record(stage_ / (tile + std::string(".done")), {piece_files(stage_, {cols, laz}), {}});
    }
  }
  test::TemporaryFolder folder_;
  fs::path work_ = folder_ / ".swath", stage_ = work_ / stage_name;
};

TEST_F(Work, WhatIsWholeStays) {
  const EarlierWork found = keep_whole_work(work_);
  EXPECT_EQ(found.lines, 1u);
  EXPECT_EQ(found.pieces, 2u);
  EXPECT_EQ(found.damaged, 0u);
  EXPECT_TRUE(fs::exists(stage_ / "products/points/b.laz"));
  EXPECT_TRUE(fs::exists(stage_ / "strip_0001/0_0.pts"));
}

TEST_F(Work, ADamagedPieceGoesWithAllItsFiles) {
  test::write_bytes(stage_ / "products/points/a.laz", "Points of a");
  fs::remove(stage_ / "strip_0001/0_0.pts");
  const EarlierWork found = keep_whole_work(work_);
  EXPECT_EQ(found.lines, 0u);
  EXPECT_EQ(found.pieces, 1u);
  EXPECT_EQ(found.damaged, 2u);
  EXPECT_FALSE(fs::exists(stage_ / "a.done"));
  EXPECT_FALSE(fs::exists(stage_ / "a.cols"));
  EXPECT_FALSE(fs::exists(stage_ / "products/points/a.laz"));
  EXPECT_FALSE(fs::exists(stage_ / "strip_0001"));
  EXPECT_TRUE(fs::exists(stage_ / "b.done"));
}

TEST_F(Work, WhatBelongsToNoPieceGoes) {
  test::write_bytes(stage_ / "products/points/old.laz", "of another tiling");
  test::write_bytes(stage_ / "strip_0002.part/0_0.pts", "half a line");
  fs::create_symlink(folder_ / "elsewhere", stage_ / "link");
  fs::remove(stage_ / "b.done");
  EXPECT_EQ(keep_whole_work(work_).damaged, 0u);
  EXPECT_FALSE(fs::exists(stage_ / "products/points/old.laz"));
  EXPECT_FALSE(fs::exists(stage_ / "strip_0002.part"));
  EXPECT_FALSE(fs::is_symlink(stage_ / "link"));
  EXPECT_FALSE(fs::exists(stage_ / "b.cols"));
  EXPECT_TRUE(fs::exists(stage_ / "a.cols"));
}

TEST_F(Work, OnlyTheStagesOfThePlanStay) {
  fs::create_directories(work_ / "04-terrain.dtm-0123456789abcdef");
  test::write_bytes(work_ / "lock", "");
  sweep(work_, {"04-terrain.dtm-0123456789abcdef"});
  EXPECT_EQ(test::entries(work_), 2u);
}

}  // namespace
}  // namespace swath::pipeline
