// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/config_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

class ConfigFolder : public ::testing::Test {
 protected:
  ConfigFolder() {
    for (const char* name : {"coast.toml", "river.toml"}) std::ofstream(folder_.path() / name) << "[run]\n";
    std::ofstream(folder_.path() / "notes.txt") << "not a config\n";
    setenv("SWATH_CONFIGS", folder_.path().c_str(), 1);
  }
  ~ConfigFolder() override { unsetenv("SWATH_CONFIGS"); }
  std::string fault(const fs::path& given) const {
    try {
      find_config(given);
    } catch (const core::Error& e) {
      EXPECT_EQ(e.code(), core::Exit::bad_usage);
      return e.text();
    }
    return "found";
  }
  test::TemporaryFolder folder_;
};

TEST_F(ConfigFolder, ANameIsAFileOfTheFolder) {
  EXPECT_EQ(find_config("coast"), folder_.path() / "coast.toml");
  const auto names = config_names();
  EXPECT_NE(std::find(names.begin(), names.end(), "river"), names.end());
  EXPECT_EQ(std::find(names.begin(), names.end(), "notes"), names.end());
}

TEST_F(ConfigFolder, AFileIsTakenBeforeAName) {
  const fs::path before = fs::current_path();
  test::TemporaryFolder here;
  fs::current_path(here.path());
  fs::create_directory("river");  // a folder is no config: the name is looked for
  std::ofstream("coast") << "[run]\n";
  const fs::path file = find_config("coast"), named = find_config("river");
  fs::current_path(before);
  EXPECT_EQ(file, "coast");
  EXPECT_EQ(named, folder_.path() / "river.toml");
}

TEST_F(ConfigFolder, WhatIsNotThereIsOneErrorWithTheNearest) {
  EXPECT_NE(fault("coats").find("did you mean 'coast'?"), std::string::npos) << fault("coats");
  EXPECT_NE(fault("mountain").find("coast, "), std::string::npos) << fault("mountain");
  EXPECT_NE(fault("coast.tml").find("no such file"), std::string::npos);
  EXPECT_NE(fault(folder_.path() / "coats").find("check the name of the config"), std::string::npos);
}

}  // namespace
}  // namespace swath::pipeline
