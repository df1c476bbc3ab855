// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/earlier_survey.h"

#include <chrono>
#include <fstream>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::simulate {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

/// A file of an hour ago.
void write_old(const fs::path& file) {
  fs::create_directories(file.parent_path());
  test::write_bytes(file, "old");
  fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(1));
}

TEST(EarlierSurvey, WhatIsNotWrittenAnewGoes) {
  const test::TemporaryFolder folder;
  for (const char* name : {"survey.toml", "laser.npy", "survey_las.toml", "laser.las", "my_survey.toml", "notes.txt", "out/laser.las",
                           "sbet.out", "truth/simulation.json", "truth/trees.csv"})
    write_old(folder / name);
  const EarlierSurvey earlier(folder.path());
  for (const char* name : {"survey.toml", "laser.npy", "truth/simulation.json"}) test::write_bytes(folder / name, "new");
  EXPECT_EQ(earlier.remove_stale({folder / "sbet.out"}), (Names{"laser.las", "survey_las.toml", "truth/trees.csv"}));
  for (const char* name : {"survey.toml", "laser.npy", "my_survey.toml", "notes.txt", "out/laser.las", "sbet.out"})
    EXPECT_TRUE(fs::exists(folder / name)) << name;
}

TEST(EarlierSurvey, RecordsThatNoSimulationWroteAreRefused) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(EarlierSurvey(folder / "absent").remove_stale(), Names{});
  write_old(folder / "flight.las");
  EXPECT_EQ(EarlierSurvey(folder.path()).remove_stale(), Names{});  // of other names
  for (const char* name : {"survey.toml", "laser.las", "sbet.out", "imu.csv", "gnss.csv", "smrmsg.out"}) write_old(folder / name);
  try {
    EarlierSurvey{folder.path()};
    FAIL() << "records of another survey would be overwritten";
  } catch (const core::Error& e) {
    EXPECT_EQ(e.code(), core::Exit::bad_usage);
    EXPECT_EQ(std::string(e.what()),
              "the folder holds gnss.csv, imu.csv, laser.las, sbet.out, smrmsg.out and 1 more, which no simulation wrote: records there "
              "could be overwritten");
    EXPECT_EQ(e.where(), folder.path().string());
  }
  EXPECT_TRUE(fs::exists(folder / "laser.las"));
  std::ofstream(folder / "survey.toml") << "# Simulated survey; truth/ holds what is known of it.\n";
  EXPECT_NO_THROW(EarlierSurvey{folder.path()}) << "its truth was taken out of it";
}

// A simulation that was killed has not come to its list of options, but has made the folder of the truth.
TEST(EarlierSurvey, AnUnfinishedSimulationIsMadeAgain) {
  const test::TemporaryFolder folder;
  write_old(folder / "laser.las");
  fs::create_directories(folder / "truth");
  EXPECT_EQ(EarlierSurvey(folder.path()).remove_stale(), Names{});
  EXPECT_TRUE(fs::exists(folder / "laser.las"));
}

}  // namespace
}  // namespace swath::simulate
