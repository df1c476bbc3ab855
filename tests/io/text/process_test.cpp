// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/process.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;

class Process : public testing::Test {
 protected:
  /// A shell script that may be run.
  fs::path script(const std::string& name, const std::string& text) {
    test::write_bytes(folder_ / name, "#!/bin/sh\n" + text);
    fs::permissions(folder_ / name, fs::perms::owner_all);
    return folder_ / name;
  }
  std::string log() const { return test::read_bytes(folder_ / "log"); }
  test::TemporaryFolder folder_;
};

TEST_F(Process, ArgumentsReachTheProgramAsTheyAre) {
  const fs::path p = script("list", "for a in \"$@\"; do echo \"[$a]\"; done; echo seen >&2; pwd\n");
  fs::create_directory(folder_ / "work here");
  const ProcessEnd end = run_program(p, {"two words", "$HOME `ls` ; *", "", "a'b\"c"}, folder_ / "work here", folder_ / "log");
  EXPECT_TRUE(end.well());
  EXPECT_EQ(log(), "[two words]\n[$HOME `ls` ; *]\n[]\n[a'b\"c]\nseen\n" + fs::canonical(folder_ / "work here").string() + "\n");
}

TEST_F(Process, NothingIsToBeRead) {
  EXPECT_TRUE(run_program(script("cat", "cat; echo done\n"), {}, folder_.path(), folder_ / "log").well());
  EXPECT_EQ(log(), "done\n");
}

TEST_F(Process, TellsHowItEnded) {
  const ProcessEnd three = run_program(script("three", "exit 3\n"), {}, folder_.path(), folder_ / "log");
  EXPECT_EQ(three.code, 3);
  EXPECT_FALSE(three.well());
  EXPECT_EQ(three.text(), "exit code 3");
  const ProcessEnd killed = run_program(script("kill", "kill -9 $$\n"), {}, folder_.path(), folder_ / "log");
  EXPECT_EQ(killed.signal, SIGKILL);
  EXPECT_FALSE(killed.well());
  EXPECT_NE(killed.text().find("signal 9"), std::string::npos);
}

TEST_F(Process, WhatCannotBeStartedIsAnError) {
  EXPECT_THROW(run_program(folder_ / "none", {}, folder_.path(), folder_ / "log"), core::Error);
  EXPECT_THROW(run_program(script("ok", "exit 0\n"), {}, folder_ / "no folder", folder_ / "log"), core::Error);
}

TEST_F(Process, WhatTakesTooLongIsEnded) {
  const fs::path endless = script("endless", "echo $$; exec sleep 600\n");
  const ProcessEnd end = run_program(endless, {}, folder_.path(), folder_ / "log", 0.3);
  EXPECT_TRUE(end.too_long);
  EXPECT_FALSE(end.well());
  EXPECT_EQ(end.text(), "its time limit");
  EXPECT_NE(::kill(std::stoi(log()), 0), 0) << "it still runs";
  EXPECT_TRUE(run_program(script("quick", "exit 0\n"), {}, folder_.path(), folder_ / "log", 60.0).well());
  // A shell that waits for what it started.
  EXPECT_TRUE(run_program(script("wrapper", "sleep 600 & echo $!\nwait\n"), {}, folder_.path(), folder_ / "log", 0.3).too_long);
  const pid_t started = std::stoi(log());
  for (int tries = 0; tries < 500 && ::kill(started, 0) == 0; ++tries) ::usleep(10000);
  EXPECT_NE(::kill(started, 0), 0) << "it still runs";
}

TEST_F(Process, AProgramDoesNotOutliveItsCaller) {
  const fs::path endless = script("endless", "echo $$; exec sleep 600\n");
  const pid_t caller = ::fork();
  if (caller == 0) {
    run_program(endless, {}, folder_.path(), folder_ / "log");
    ::_exit(0);
  }
  const auto logged = [&] { return fs::exists(folder_ / "log") ? log() : std::string(); };
  for (int tries = 0; tries < 500 && logged().find('\n') == std::string::npos; ++tries) ::usleep(10000);
  const pid_t program = std::stoi(logged());
  ASSERT_EQ(::kill(program, 0), 0);
  ::kill(caller, SIGKILL);
  ::waitpid(caller, nullptr, 0);
  // A program without a parent is nobody's to wait for here: it is gone, or dead and not yet collected.
  const auto runs = [&] {
    const std::string state =
        fs::exists("/proc/" + std::to_string(program)) ? test::read_bytes("/proc/" + std::to_string(program) + "/stat") : "";
    return !state.empty() && state.find(") Z") == std::string::npos;
  };
  for (int tries = 0; tries < 500 && runs(); ++tries) ::usleep(10000);
  EXPECT_FALSE(runs());
}

TEST_F(Process, ProgramsAreFoundOnPath) {
  const fs::path here = script("swath-test-program", "exit 0\n");
  test::write_bytes(folder_ / "plain", "no program");
  EXPECT_EQ(find_program(here), here);
  EXPECT_TRUE(find_program(folder_ / "plain").empty());
  EXPECT_TRUE(find_program(folder_.path()).empty());
  EXPECT_TRUE(find_program("").empty());
  EXPECT_TRUE(find_program("swath-test-program").empty());
  const std::string before = std::getenv("PATH") ? std::getenv("PATH") : "";
  ::setenv("PATH", ("/nonexistent:" + folder_.path().string()).c_str(), 1);
  EXPECT_EQ(find_program("swath-test-program"), here);
  ::setenv("PATH", before.c_str(), 1);
}

}  // namespace
}  // namespace swath::io
