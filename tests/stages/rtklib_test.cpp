// SPDX-License-Identifier: GPL-3.0-or-later
// Over 400 lines: one stage, whose cases share the script that stands for the program.
// The stage with a script in the place of RTKLIB's program, and with the program itself where it is installed.
#include <Eigen/Geometry>
#include <cstdio>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "core/time.h"
#include "io/gnss/rtklib_pos.h"
#include "io/text/process.h"
#include "stages/registry.h"
#include "tests/world/support.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::FixQuality;

const Eigen::Vector3d place(4027893.8, 306998.2, 4919498.9);
constexpr int week = 1851;
constexpr double start = 300000.0;  // s of week
constexpr double digit = 1e-4;      // m, the last one written

std::string header_line(std::string text, const std::string& label) {
  text.resize(60, ' ');
  return text + label + "\n";
}

std::string xyz(const Eigen::Vector3d& p) {
  char text[64];
  std::snprintf(text, sizeof text, "%14.4f%14.4f%14.4f", p.x(), p.y(), p.z());
  return text;
}

/// Observations of one satellite once a second from second `from` of the record, for `n` seconds.
std::string observations(const std::string& marker, const Eigen::Vector3d& position, int from, int n) {
  std::string out = header_line("     3.04           OBSERVATION DATA    M", "RINEX VERSION / TYPE") + header_line(marker, "MARKER NAME") +
                    header_line("12345               TRM41249.00     NONE", "ANT # / TYPE") +
                    header_line(xyz(position), "APPROX POSITION XYZ") +
                    header_line("        1.5000        0.0000        0.0000", "ANTENNA: DELTA H/E/N") + header_line("", "END OF HEADER");
  for (int k = from; k < from + n; ++k) {
    const int s = static_cast<int>(start) % 86400 + k;  // 2015-07-01 is day 3 of its week
    char text[64];
    std::snprintf(text, sizeof text, "> 2015 07 01 %02d %02d %10.7f  0  1\nG01  20000000.123\n", s / 3600, s / 60 % 60,
                  static_cast<double>(s % 60));
    out += text;
  }
  return out;
}

std::string solution(const Eigen::Vector3d& p, int from, int n, int quality, double sigma = 0.01) {
  std::string out =
      "%  GPST                 x-ecef(m)      y-ecef(m)      z-ecef(m)   Q  ns   sdx(m)   sdy(m)   sdz(m)  sdxy(m)  sdyz(m)  sdzx(m)\n";
  for (int k = from; k < from + n; ++k) {
    char text[256];
    std::snprintf(text, sizeof text, "%d %.6f %.4f %.4f %.4f %d 9 %.4f %.4f %.4f 0.0000 0.0000 0.0000\n", week, start + k, p.x(), p.y(),
                  p.z(), quality, sigma, sigma, sigma);
    out += text;
  }
  return out;
}

class RtklibStage : public testing::Test {
 protected:
  RtklibStage() : stage(make_stage("gnss.rtklib")) {
    // The script answers with the file named by the markers of rover and base.
    test::write_bytes(folder / "rnx2rtkp",
                      "#!/bin/sh\nmarker() { sed -n 's/ *MARKER NAME//p' $1 | head -1; }\n"
                      "name=$(marker rover_001.obs)\n[ -f base_001.obs ] && name=$name-$(marker base_001.obs)\n"
                      "cat \"" +
                          (folder / "answers").string() + "/$name\" > solution.pos 2>/dev/null || echo 'error : no nav data' >&2\n");
    fs::permissions(folder / "rnx2rtkp", fs::perms::owner_all);
    test::write_bytes(folder / "day.15n", header_line("     3.04           N: GNSS NAV DATA    M", "RINEX VERSION / TYPE"));
    test::write_bytes(folder / "air.obs", observations("AIR", place, 0, 100));
    survey.rinex.rover = {folder / "air.obs"};
    survey.rinex.navigation = {folder / "day.15n"};
    context.output = folder / "out";
    set("program", (folder / "rnx2rtkp").string());
  }

  void set(const std::string& option, core::Value value) {
    const core::Describe d = [&](core::Visitor& v) { stage->visit(v); };
    core::Value values = core::effective_values(d);
    values[option] = std::move(value);
    std::vector<core::Fault> faults;
    core::read_options(d, values, "", faults);
    ASSERT_TRUE(faults.empty()) << faults.front().text();
  }
  void answer(const std::string& name, const std::string& text) { test::write_bytes(folder / "answers" / name, text); }
  /// A base so far east of the rover, with its own solution and that of the rover.
  void base(const std::string& name, double distance, const std::string& solved, int from = 0, int n = 100) {
    const Eigen::Vector3d p = place + distance * Eigen::Vector3d(-place.y(), place.x(), 0).normalized();
    test::write_bytes(folder / (name + ".obs"), observations(name, p + Eigen::Vector3d(2, -1, 3), from, n));
    answer(name, solution(p + Eigen::Vector3d(1, 2, -2), from, 3, 5, 4.0));
    if (!solved.empty()) answer("AIR-" + name, solved);
    io::BaseStation b;
    b.observations = {folder / (name + ".obs")};
    b.position = {core::Metres(p.x()), core::Metres(p.y()), core::Metres(p.z())};
    survey.rinex.bases.push_back(b);
  }
  void run() {
    tally = {};
    findings = core::Value::object();
    stage->check(context);
    stage->run_survey(context, tally, findings);
  }
  std::string fault() {
    try {
      run();
    } catch (const core::Error& e) {
      EXPECT_EQ(context.records.find<core::GnssData>(), nullptr);
      return e.text();
    }
    return "none";
  }
  double number(const core::Value& v, const std::string& key) { return v.find(key) ? v.find(key)->as_number() : -1; }

  test::TemporaryFolder folder;
  io::Survey survey;
  Context context{survey};
  std::unique_ptr<Stage> stage;
  core::Tally tally;
  core::Value findings;
};

#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

TEST_F(RtklibStage, TakesTheNearestBaseAndTellsWhatItIsWorth) {
  base("FAR", 30000, solution(place, 0, 100, 1));
  base("NEAR", 8000,
       solution(place + Eigen::Vector3d(0.1, 0, 0), 0, 70, 1) + solution(place, 75, 15, 2, 0.2) + solution(place, 90, 5, 4, 0.5));
  run();
  ASSERT_NE(context.records.find<core::GnssData>(), nullptr);
  EXPECT_EQ(context.records.get<core::GnssData>().size(), 90u);
  EXPECT_NEAR((context.records.get<core::GnssData>().position[0] - place).x(), 0.1, digit);
  EXPECT_NEAR(context.records.get<core::GnssData>().time[0], core::from_week(week, start), 1e-6);
  const core::Value& bases = *findings.find("bases");
  ASSERT_EQ(bases.items().size(), 2u);
  EXPECT_EQ(bases.items()[0].find("not_used")->as_text(), "nearer ones are enough");
  const core::Value& near = bases.items()[1];
  EXPECT_EQ(near.find("name")->as_text(), "NEAR");
  EXPECT_NEAR(number(near, "distance_m"), 8000, digit);
  EXPECT_EQ(number(near, "fixed"), 70);
  EXPECT_EQ(number(near, "float"), 15);
  EXPECT_EQ(number(near, "differential"), 5);
  EXPECT_NEAR(number(near, "fixed_percent"), 100 * 70 / 90.0, 1e-9);
  EXPECT_NEAR(number(near, "rover_epochs_percent"), 90, 1e-9);
  EXPECT_EQ(number(near, "gaps"), 1);
  EXPECT_EQ(number(near, "longest_gap_s"), 6);
  EXPECT_NEAR(number(near, "code_solution_off_m"), 3, digit);
  EXPECT_EQ(number(*findings.find("rover"), "epochs"), 100);
  EXPECT_EQ(tally.of("epochs of the rover without a solution"), 10u);
  for (const char* name : {"NEAR.pos", "NEAR.conf", "NEAR.log"}) EXPECT_TRUE(fs::exists(folder / "out" / "gnss" / name)) << name;
  EXPECT_EQ(test::entries(folder / "out" / "gnss"), 3u) << "nothing else stays";
  EXPECT_EQ(stage->products(), std::vector<std::string>{"gnss"});
  const std::string conf = test::read_bytes(folder / "out" / "gnss" / "NEAR.conf");
  EXPECT_SAYS(conf, "ant2-antdelu=1.5\n");
  EXPECT_SAYS(conf, "ant1-antdelu=0\n");
}

TEST_F(RtklibStage, TheAntennasLatencyIsAdded) {
  base("NEAR", 8000, solution(place, 0, 100, 1));
  survey.antenna.latency = core::Seconds(0.25);
  run();
  EXPECT_NEAR(context.records.get<core::GnssData>().time[0], core::from_week(week, start) + 0.25, 1e-6);
}

TEST_F(RtklibStage, SeveralBasesBecomeOneSolution) {
  base("A", 8000, solution(place, 0, 60, 1) + solution(place, 60, 40, 2, 0.3));
  base("B", 20000,
       solution(place + Eigen::Vector3d(0.01, 0, 0), 0, 50, 1) + solution(place + Eigen::Vector3d(0.5, 0, 0), 50, 10, 1) +
           solution(place, 60, 20, 1));
  base("C", 30000, solution(place, 0, 100, 1));
  set("bases", "2");
  run();
  ASSERT_EQ(context.records.get<core::GnssData>().size(), 100u);
  const core::Value& all = *findings.find("combined");
  EXPECT_EQ(number(all, "averaged"), 50);
  EXPECT_EQ(number(all, "disagreeing"), 10);
  EXPECT_EQ(number(all, "fixed"), 80);
  const core::Value::Array& taken = all.find("taken")->items();
  EXPECT_EQ(taken[0].find("name")->as_text(), "A");
  EXPECT_EQ(number(taken[0], "epochs"), 80);
  EXPECT_EQ(number(taken[1], "epochs"), 20);
  EXPECT_NEAR(number(all, "worst_disagreement_m"), 0.5, digit);
  EXPECT_NEAR((context.records.get<core::GnssData>().position[0] - place).x(), 0.005, digit);
  EXPECT_EQ(context.records.get<core::GnssData>().quality[70], FixQuality::fixed);
  EXPECT_EQ(tally.of("epochs at which fixed solutions of several bases disagree"), 10u);
  EXPECT_EQ(io::read_pos(folder / "out" / "gnss" / "combined.pos", {}, 0.0, tally).size(), 100u);
  set("bases", "all");
  run();
  EXPECT_EQ(number(*findings.find("combined"), "averaged"), 80) << "C stands by A, or by B where A floats";
}

TEST_F(RtklibStage, OneBaseOfSeveralMayFail) {
  base("A", 8000, "");
  base("B", 20000, solution(place, 0, 100, 1));
  set("bases", "all");
  run();
  EXPECT_EQ(context.records.get<core::GnssData>().size(), 100u);
  EXPECT_EQ(tally.of("bases without a solution"), 1u);
  EXPECT_SAYS(findings.find("bases")->items()[0].find("failed")->as_text(), "no nav data");
}

TEST_F(RtklibStage, ABaseBeyondTheLimitIsAnErrorWithItsDistance) {
  base("FAR", 60000, solution(place, 0, 100, 1));
  EXPECT_SAYS(fault(), "no base station within 50.0 km of the rover: FAR 60.0 km");
  set("max_distance", "70 km");
  run();
  EXPECT_EQ(context.records.get<core::GnssData>().size(), 100u);
}

TEST_F(RtklibStage, WithoutAnApproximatePositionTheFirstFixCounts) {
  test::write_bytes(folder / "air.obs", observations("AIR", Eigen::Vector3d::Zero(), 0, 100));
  base("FAR", 60000, solution(place, 0, 100, 1));
  EXPECT_SAYS(fault(), "no approximate position, and no fix was found");
  answer("AIR", solution(place, 0, 100, 5, 4.0));
  EXPECT_SAYS(fault(), "FAR 60.0 km");
  set("max_distance", "70 km");
  run();
  EXPECT_EQ(findings.find("rover")->find("approximate_position_from")->as_text(), "first fix by code");
}

TEST_F(RtklibStage, BasesThatRecordAtOtherTimesAreNotUsed) {
  base("BEFORE", 8000, solution(place, 0, 100, 1), -500, 400);
  const std::string text = fault();
  EXPECT_SAYS(text, "no base station records while the rover does (2015-07-01T11:19:43");
  EXPECT_SAYS(text, "BEFORE 2015-07-01T11:11:23");
  base("HALF", 9000, solution(place, 50, 50, 1), 50, 400);
  run();
  EXPECT_EQ(context.records.get<core::GnssData>().size(), 50u);
  EXPECT_EQ(tally.of("base that does not record over the whole flight"), 1u);
  EXPECT_NEAR(number(findings.find("bases")->items()[1], "overlap_percent"), 100 * 49 / 99.0, 1e-9);
}

TEST_F(RtklibStage, AWrongBasePositionIsFound) {
  base("NEAR", 8000, solution(place, 0, 100, 1));
  survey.rinex.bases[0].position->at(1).value += 1000;
  const std::string text = fault();
  EXPECT_SAYS(text, "the base 'NEAR' lies 99");
  EXPECT_SAYS(text, "m from its stated position");
  set("base_tolerance", "2 km");
  run();
}

TEST_F(RtklibStage, ABaseMayStandWhereItsHeaderSays) {
  base("NEAR", 8000, solution(place, 0, 100, 1));
  survey.rinex.bases[0].position.reset();
  run();
  EXPECT_EQ(tally.of("base at the approximate position of its RINEX header: all fixes are wrong by what it is wrong"), 1u);
  test::write_bytes(folder / "NEAR.obs", observations("NEAR", Eigen::Vector3d::Zero(), 0, 100));
  context.records.drop<core::GnssData>();
  EXPECT_SAYS(fault(), "the base 'NEAR' has no position");
}

TEST_F(RtklibStage, NoSolutionIsAnError) {
  base("NEAR", 8000, "");
  const std::string text = fault();
  EXPECT_SAYS(text, "rnx2rtkp found no solution for NEAR; it says: error : no nav data");
  EXPECT_SAYS(text, "navigation files");
}

TEST_F(RtklibStage, FewFixedEpochsAreTold) {
  base("NEAR", 8000, solution(place, 0, 40, 1) + solution(place, 40, 60, 2, 0.3));
  run();
  EXPECT_EQ(tally.of("base with fewer than half of the epochs fixed"), 1u);
}

TEST_F(RtklibStage, AMissingProgramNamesItsPackage) {
  base("NEAR", 8000, solution(place, 0, 100, 1));
  set("program", "/nonexistent");
  const std::string text = fault();
  EXPECT_SAYS(text, "the program '/nonexistent' is not found");
  EXPECT_SAYS(text, "apt-get install rtklib");
  EXPECT_THROW(stage->check(context), core::Error) << "before anything runs";
}

TEST_F(RtklibStage, FaultsOfTheSurveyAreFoundBeforeAnythingRuns) {
  const auto refused = [&](auto change, const std::string& part) {
    const io::Rinex before = survey.rinex;
    change(survey.rinex);
    try {
      stage->check(context);
      ADD_FAILURE() << part;
    } catch (const core::Error& e) {
      EXPECT_SAYS(e.text(), part);
    }
    survey.rinex = before;
  };
  base("NEAR", 8000, solution(place, 0, 100, 1));
  stage->check(context);
  refused([](io::Rinex& r) { r.rover.clear(); }, "no rover");
  refused([](io::Rinex& r) { r.navigation.clear(); }, "no navigation files");
  refused([](io::Rinex& r) { r.bases.clear(); }, "no [[rinex.base]]");
  refused([](io::Rinex& r) { r.bases[0].observations.clear(); }, "has no observations");
  refused([](io::Rinex& r) { r.bases[0].antenna_type = "*"; }, "no antenna_file");
}

TEST_F(RtklibStage, NavigationFilesAreLookedAt) {
  base("NEAR", 8000, solution(place, 0, 100, 1));
  survey.rinex.navigation = {folder / "none.15n"};
  EXPECT_SAYS(fault(), "none.15n");
  survey.rinex.navigation = {folder / "air.obs"};
  EXPECT_SAYS(fault(), "air.obs: is no navigation file");
  test::write_bytes(folder / "orbits.sp3", "#cP2015  7  1  0  0  0.00000000      96 ORBIT IGb08 HLM  IGS\n");
  survey.rinex.navigation = {folder / "orbits.sp3"};
  run();
  EXPECT_SAYS(test::read_bytes(folder / "out" / "gnss" / "NEAR.conf"), "pos1-sateph=precise\n");
  context.records.drop<core::GnssData>();
  set("orbits", "broadcast");
  EXPECT_SAYS(fault(), "names no RINEX navigation file");
  survey.rinex.navigation = {folder / "day.15n"};
  set("orbits", "precise");
  EXPECT_SAYS(fault(), "names no SP3 file");
}

TEST_F(RtklibStage, AntennasComeFromHeadersAndTheAntennaFile) {
  base("NEAR", 8000, solution(place, 0, 100, 1));
  test::write_bytes(folder / "a.atx",
                    header_line("     1.4            M", "ANTEX VERSION / SYST") + header_line("TRM41249.00     NONE", "TYPE / SERIAL NO"));
  survey.rinex.antenna_file = folder / "a.atx";
  survey.rinex.bases[0].antenna_type = "*";
  survey.rinex.bases[0].antenna_offset = {core::Metres(0.1), core::Metres(0.2), core::Metres(0.3)};
  run();
  std::string conf = test::read_bytes(folder / "out" / "gnss" / "NEAR.conf");
  EXPECT_SAYS(conf, "ant2-anttype=TRM41249.00     NONE\n");
  EXPECT_SAYS(conf, "ant2-antdele=0.1\nant2-antdeln=0.2\nant2-antdelu=0.3\n");
  EXPECT_EQ(tally.of("antenna without a type: its phase centre is not applied"), 1u) << "the rover's";
  context.records.drop<core::GnssData>();
  survey.rinex.antenna_type = "TRM41249.01";
  EXPECT_SAYS(fault(), "the antenna 'TRM41249.01' is not in this file");
}

TEST_F(RtklibStage, DynamicsNeedFrequentEpochs) {
  base("NEAR", 8000, solution(place, 0, 100, 1));
  set("dynamics", true);
  run();
  context.records.drop<core::GnssData>();
  std::string sparse = observations("AIR", place, 0, 1);
  for (int k = 1; k < 5; ++k) {
    const std::string epoch = observations("AIR", place, 30 * k, 1);
    sparse += epoch.substr(epoch.find('>'));
  }
  test::write_bytes(folder / "air.obs", sparse);
  EXPECT_SAYS(fault(), "dynamics with an epoch every 30 s");
}

TEST_F(RtklibStage, BasesAreANumberOrNamed) {
  const core::Describe d = [&](core::Visitor& v) { stage->visit(v); };
  for (const char* bad : {"some", "0", "-1", "1.5", ""}) {
    core::Value values = core::effective_values(d);
    values["bases"] = bad;
    std::vector<core::Fault> faults;
    core::read_options(d, values, "", faults);
    EXPECT_FALSE(faults.empty()) << bad;
  }
}

/// Two stations 3.3 km apart, an hour.
class RtklibItself : public RtklibStage {
 protected:
  void stations(const fs::path& data) {
    set("program", "rnx2rtkp");
    survey.rinex.rover = {data / "07590920.05o"};
    survey.rinex.navigation = {data / "07590920.05n"};
    io::BaseStation b;
    b.observations = {data / "30400920.05o"};
    b.position = {core::Metres(-3978241.958), core::Metres(3382840.234), core::Metres(3649900.853)};
    survey.rinex.bases = {b};
  }
  Eigen::Vector3d mean() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : context.records.get<core::GnssData>().position)
      sum += p / static_cast<double>(context.records.get<core::GnssData>().size());
    return sum;
  }
};

#define RNX2RTKP_OR_SKIP() \
  if (io::find_program("rnx2rtkp").empty()) GTEST_SKIP() << "rnx2rtkp is not installed (Debian package rtklib)"

TEST_F(RtklibItself, AgreesWithTheProgramCalledByHand) {
  SWATH_SHARED_OR_SKIP(data, "data/rinex_rtklib");
  RNX2RTKP_OR_SKIP();
  stations(data);
  run();
  EXPECT_GE(context.records.get<core::GnssData>().size(), 115u);
  EXPECT_GT(number(findings, "fixed_percent"), 95);
  // rnx2rtkp -p 2 -c -m 15 -f 2 -e -r (base), 2.4.3 b34. Its settings are not those of an aircraft (mask 15 deg, no mask for fixing), which
  // moves the mean by less than the millimetres of one epoch's sigma.
  const Eigen::Vector3d by_hand(-3976219.1875, 3382371.6043, 3652511.1414);
  constexpr double agreement = 0.005;
  EXPECT_LT((mean() - by_hand).norm(), agreement) << (mean() - by_hand).transpose();
  // The same configuration by hand gives the same file.
  const fs::path conf = folder / "out" / "gnss" / "3040.conf";
  ASSERT_TRUE(io::run_program(io::find_program("rnx2rtkp"),
                              {"-k", conf.string(), "-o", (folder / "hand.pos").string(), (data / "07590920.05o").string(),
                               (data / "30400920.05o").string(), (data / "07590920.05n").string()},
                              folder.path(), folder / "hand.log")
                  .well());
  const core::GnssData hand = io::read_pos(folder / "hand.pos", {}, 0.0, tally);
  ASSERT_EQ(hand.size(), context.records.get<core::GnssData>().size());
  for (size_t i = 0; i < hand.size(); ++i) EXPECT_EQ(hand.position[i], context.records.get<core::GnssData>().position[i]);
}

TEST_F(RtklibItself, WrongInputsAreOneClearError) {
  SWATH_SHARED_OR_SKIP(data, "data/rinex_rtklib");
  RNX2RTKP_OR_SKIP();
  stations(data);
  survey.rinex.bases[0].position->at(0).value += 1000;
  EXPECT_SAYS(fault(), "m from its stated position by its own code ranges");
  stations(data);
  survey.rinex.navigation = {data / "none.05n"};
  EXPECT_SAYS(fault(), "none.05n");
  stations(data);
  // Navigation of no satellite.
  survey.rinex.navigation = {folder / "day.15n"};
  EXPECT_SAYS(fault(), "rnx2rtkp found no solution");
  stations(data);
  survey.rinex.bases[0].position->at(2).value -= 60000;
  EXPECT_SAYS(fault(), "3040 ");
}

TEST_F(RtklibItself, RunsTwiceAlike) {
  SWATH_SHARED_OR_SKIP(data, "data/rinex_rtklib");
  RNX2RTKP_OR_SKIP();
  stations(data);
  run();
  const std::string first = test::read_bytes(folder / "out" / "gnss" / "3040.pos");
  fs::remove_all(folder / "out");
  run();
  EXPECT_EQ(test::read_bytes(folder / "out" / "gnss" / "3040.pos"), first);
}

}  // namespace
}  // namespace swath::stages
