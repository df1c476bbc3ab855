// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/rtklib_run.h"

#include "core/error.h"
#include "io/text/process.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;

/// Runs scripts in the place of rnx2rtkp.
class RtklibRun : public testing::Test {
 protected:
  RtklibRun() {
    for (const char* name : {"a*%r.obs", "second.obs", "base.obs"})
      test::write_bytes(folder_ / "in put" / name, std::string("text of ") + name);
    test::write_bytes(folder_ / "in put" / "orbits", "#cP2015  7  1  0  0  0.00000000      96 ORBIT IGb08 HLM  IGS\n");
    test::write_bytes(folder_ / "in put" / "day.15n", "     2.11           N: GPS NAV DATA                         RINEX VERSION / TYPE\n");
    job_.products = folder_ / "gnss";
    job_.name = "one";
    job_.rover = {in("a*%r.obs")};
    job_.base = {in("base.obs")};
    job_.navigation = {in("day.15n")};
    job_.setup.base = Eigen::Vector3d(4027893.8, 306998.2, 4919498.9);
  }
  fs::path in(const std::string& name) const { return folder_ / "in put" / name; }
  fs::path run(const std::string& script) {
    test::write_bytes(folder_ / "program", "#!/bin/sh\n" + script);
    fs::permissions(folder_ / "program", fs::perms::owner_all);
    job_.program = folder_ / "program";
    return run_rtklib(job_);
  }
  std::string fault(const std::string& script) {
    try {
      run(script);
    } catch (const core::Error& e) {
      EXPECT_FALSE(fs::exists(job_.products / "one.pos"));
      EXPECT_FALSE(fs::exists(job_.products / ".work-one"));
      return e.text();
    }
    return "none";
  }
  std::string log() const { return test::read_bytes(job_.products / "one.log"); }
  test::TemporaryFolder folder_;
  RtklibJob job_;
};

constexpr const char* solved = "echo '1316 518400.0 1 2 3 1 7' > solution.pos\n";

TEST_F(RtklibRun, TheProgramSeesPlainNamesAndTheConfiguration) {
  job_.rover.push_back(in("second.obs"));
  job_.navigation.push_back(in("orbits"));
  const fs::path pos =
      run("echo \"$@\"; cat rover_001.obs rover_002.obs base_001.obs; echo; grep -c = rtklib.conf; ls; " + std::string(solved));
  EXPECT_EQ(pos, job_.products / "one.pos");
  EXPECT_EQ(test::read_bytes(pos), "1316 518400.0 1 2 3 1 7\n");
  EXPECT_NE(log().find("-k rtklib.conf -o solution.pos rover_*.obs base_001.obs navigation_001.nav navigation_002.sp3\n"),
            std::string::npos)
      << log();
  EXPECT_NE(log().find("text of a*%r.obstext of second.obstext of base.obs"), std::string::npos) << log();
  EXPECT_NE(test::read_bytes(job_.products / "one.conf").find("pos1-posmode=kinematic\n"), std::string::npos);
  EXPECT_EQ(test::entries(job_.products), 3u) << "configuration, log, solution";
}

TEST_F(RtklibRun, ProgressIsNoPartOfTheLog) {
  run("printf 'processing : 1\\rprocessing : 2\\rwarning : odd   \\r' >&2; " + std::string(solved));
  EXPECT_EQ(log().find("processing"), std::string::npos);
  EXPECT_NE(log().find("\nwarning : odd\nexit code 0\n"), std::string::npos) << log();
}

TEST_F(RtklibRun, WithoutABaseAndWithAStep) {
  job_.base.clear();
  job_.setup.base.reset();
  job_.every = 30;
  run("echo \"$@\"; " + std::string(solved));
  EXPECT_NE(log().find("-ti 30 rover_001.obs navigation_001.nav\n"), std::string::npos) << log();
}

TEST_F(RtklibRun, FailuresAreOneClearError) {
  EXPECT_NE(fault("echo 'no licence' >&2; exit 7\n").find("rnx2rtkp failed with exit code 7; it says: no licence"), std::string::npos);
  EXPECT_NE(fault("kill -9 $$\n").find("signal 9"), std::string::npos);
  EXPECT_NE(fault("echo 'error : no nav data' >&2\n").find("no solution for one; it says: error : no nav data"), std::string::npos);
  EXPECT_NE(fault("printf '%% a head\\n%% only\\n' > solution.pos\n").find("no solution"), std::string::npos);
  EXPECT_NE(fault("echo 'invalid option value pos1-posmode (rtklib.conf:1)' >&2; " + std::string(solved)).find("does not know a value"),
            std::string::npos);
  EXPECT_NE(log().find("invalid option"), std::string::npos) << "the log stays";
}

TEST_F(RtklibRun, AMissingInputIsNamed) {
  job_.base = {in("none.obs")};
  EXPECT_NE(fault(solved).find("none.obs"), std::string::npos);
}

TEST_F(RtklibRun, WhatAStoppedRunLeftIsGone) {
  test::write_bytes(job_.products / ".work-one" / "solution.pos", "1316 1.0 1 2 3 1 7\n");
  EXPECT_NE(fault("true\n").find("no solution"), std::string::npos);
}

}  // namespace
}  // namespace swath::io
