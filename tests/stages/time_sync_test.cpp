// SPDX-License-Identifier: GPL-3.0-or-later
// The stage time.sync, run on its own.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "core/time.h"
#include "io/raster/png.h"
#include "io/text/value_file.h"
#include "stages/registry.h"
#include "tests/world/support.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

struct Trial {
  test::TemporaryFolder folder;
  io::Survey survey;
  Context context{survey};
  std::unique_ptr<Stage> stage = make_stage("time.sync");
  core::Tally tally;
  core::Value findings = core::Value::object();

  Trial() {
    survey.name = "made";
    survey.folder = folder.path();
    context.output = folder / "out";
    fs::create_directories(context.output);
  }
  io::EventFile& events(const std::string& name, const std::string& text, const core::TimeScale scale) {
    test::write_bytes(folder / name, text);
    io::EventFile& f = survey.events.emplace_back();
    f.file = name;
    f.technique = fs::path(name).stem().string();
    f.time = {scale, 1525, "2009-03-31"};
    f.columns = {"t", "id", "strip"};
    return f;
  }
  /// Two hours of a clock that is 5 ms behind and gains 1e-6; twenty events, the receiver's marks and the computer's stamps of them.
  void made_survey() {
    std::string log, stamps = "id,strip,t\n", marks = "id,strip,t\n";
    char line[120];
    for (int s = 39600; s < 46800; s += 16) {
      std::snprintf(line, sizeof line, "54921 %d %.9f 0 0.000002 0 6\n", s, 0.005 - 1e-6 * (s - 39600) + (s / 16 % 2 ? 1e-6 : -1e-6));
      log += line;
    }
    for (int i = 0; i < 20; ++i) {
      const double pc = 40005 + 400 * i, offset = 0.005 - 1e-6 * (pc - 39600);
      std::snprintf(line, sizeof line, "e%d,%d,%.7f\n", i, i / 10 + 1, pc);
      stamps += line;
      std::snprintf(line, sizeof line, "e%d,%d,%.7f\n", i, i / 10 + 1, pc + offset + 2 * 86400 + 15);
      marks += line;
    }
    test::write_bytes(folder / "loopstats", log);
    survey.clock.push_back({"loopstats", io::ClockFormat::loopstats});
    events("pc.csv", stamps, core::TimeScale::utc_day).computer_clock = true;
    events("marks.csv", marks, core::TimeScale::gps_week);
  }
  void set(const std::string& json) {
    std::vector<core::Fault> faults;
    core::read_options([&](core::Visitor& v) { stage->visit(v); }, io::parse_json(json, "options"), "", faults);
    for (const auto& f : faults) ADD_FAILURE() << f.text();
  }
  void go() {
    stage->check(context);
    stage->run_survey(context, tally, findings);
  }
  std::string refusal() {
    try {
      go();
    } catch (const core::Error& e) {
      EXPECT_FALSE(e.hint().empty());
      return e.what();
    }
    return "no error";
  }
  std::vector<std::string> rows() const {
    std::istringstream in(test::read_bytes(context.output / "events_time.csv"));
    std::vector<std::string> out;
    for (std::string line; std::getline(in, line);) out.push_back(line);
    return out;
  }
  double trusted(const char* what) const { return findings.find("comparisons")->items()[0].find("seconds")->find(what)->as_number(); }
};

constexpr double log_scatter = 2e-6;  // s, of the made log; what is left of it after smoothing is less

TEST(TimeSync, StampsMeetTheMarks) {
  Trial t;
  t.made_survey();
  t.set(R"({"speed": "60 m/s"})");
  t.go();
  ASSERT_EQ(t.context.records.get<core::EventData>().size(), 40u);
  // 17 of 20 lie within the log; the last three are flagged and left out of the comparison.
  EXPECT_EQ(t.trusted("n"), 17);
  EXPECT_LT(t.trusted("largest"), log_scatter);
  EXPECT_EQ(t.tally.of("events outside the clock's log"), 3u);
  EXPECT_EQ(t.tally.of("events before the clock had settled"), 0u);
  EXPECT_EQ(t.context.records.get<core::EventData>().doubtful[19], 1);
  EXPECT_EQ(t.context.records.get<core::EventData>().doubtful[0], 0);
  EXPECT_GT(t.context.records.get<core::EventData>().sigma[0], 5e-6);
  EXPECT_LT(t.context.records.get<core::EventData>().sigma[0], 6e-6);
  const core::Value& c = t.findings.find("comparisons")->items()[0];
  EXPECT_EQ(c.find("techniques")->as_text(), "pc - marks");
  const core::Value& pc = t.findings.find("events")->items()[0];
  EXPECT_EQ(pc.find("name")->as_text(), "pc");
  EXPECT_EQ(pc.find("outside_log")->as_int(), 3);
  EXPECT_NEAR(c.find("before_correction")->find("line")->find("drift")->as_number(), 1e-6, 1e-9);
  EXPECT_NEAR(c.find("before_correction")->find("line")->find("shift_s")->as_number(), -0.004595, 1e-6);
  EXPECT_EQ(c.find("strips")->items().size(), 2u);
  EXPECT_NEAR(c.find("metres")->find("along")->find("rms")->as_number(), 60 * t.trusted("rms"), 1e-12);
  // Seconds of week to 0.1 us, the flag, and a week that no double of GPS seconds has rounded.
  const auto rows = t.rows();
  ASSERT_EQ(rows.size(), 41u);
  EXPECT_EQ(rows[21], "e0,1,marks,1525,212820.0045950,2009-03-31T11:06:45.005Z,,,");
  EXPECT_NE(rows[20].find("outside_log"), std::string::npos) << rows[20];
  EXPECT_GT(io::read_png(t.context.output / "time_sync.png").width, 0);
  EXPECT_NE(test::read_bytes(t.context.output / "time_sync.svg").find("pc - marks"), std::string::npos);
}

/// A straight flight of an hour and a half that covers the made events.
trajectory::Trajectory flown() {
  core::TrajectoryData d;
  for (int k = 0; k <= 90000; k += 10) {
    d.time.push_back(1525 * 604800.0 + 2 * 86400 + 15 + 40000 + 0.1 * k);
    d.latitude.push_back(0.8 + 1e-6 * k);
    d.longitude.push_back(0.2), d.height.push_back(1000), d.roll.push_back(0), d.pitch.push_back(0), d.heading.push_back(0);
  }
  return trajectory::Trajectory(std::move(d), {.max_gap = core::Seconds(2)});
}

TEST(TimeSync, ATechniqueADayAwayIsNamed) {
  const auto sentences = [](bool with_trajectory, const char* date) {
    Trial t;
    t.made_survey();
    t.survey.events[0].computer_clock = false;
    t.survey.events[0].time.date = date;
    if (with_trajectory) t.context.records.put(flown());
    t.go();
    std::vector<std::string> out;
    if (const core::Value* outside = t.findings.find("outside"))
      for (const core::Value& one : outside->items()) out.push_back(one.find("sentence")->as_text());
    return out;
  };
  for (const bool with : {true, false}) {
    EXPECT_TRUE(sentences(with, "2009-03-31").empty());
    const auto day_off = sentences(with, "2009-04-01");
    ASSERT_EQ(day_off.size(), 1u);
    EXPECT_NE(day_off[0].find(with ? "all 20 events of 'pc' lie outside the trajectory: events from 2009-04-01T11:06:45"
                                   : "all 20 events of 'marks' lie outside the events of 'pc': events from 2009-03-31T11:06:45"),
              std::string::npos)
        << day_off[0];
    EXPECT_NE(day_off[0].find("1 day apart"), std::string::npos) << day_off[0];
  }
}

TEST(TimeSync, PhotosOfADroneAndAMissingOne) {
  Trial t;
  std::string photos;
  char line[160];
  for (int i = 0; i < 20; ++i) {
    if (i == 7) continue;
    std::snprintf(line, sizeof line, "%d\t%.6f\t[2264]\t-40,N\t0,E\t86,V\t44.4%03d,Lat\t1.2,Lon\t359.4,Ellh\t0.03, 0.03, 0.05\t50,Q\n",
                  i + 1, 400000 + 2.5 * i, i);
    photos += line;
  }
  test::write_bytes(t.folder / "a_Timestamp.MRK", photos);
  t.survey.events.emplace_back().file = "a_Timestamp.MRK";
  t.go();
  const core::EventData& events = t.context.records.get<core::EventData>();
  ASSERT_EQ(events.size(), 19u);
  EXPECT_TRUE(events.place[3].allFinite());
  EXPECT_EQ(t.tally.of("events missing by the pattern of intervals"), 1u);
  const core::Value& pattern = *t.findings.find("events")->items()[0].find("pattern");
  EXPECT_NEAR(pattern.find("interval_s")->as_number(), 2.5, 1e-5);
  EXPECT_EQ(pattern.find("missing")->as_int(), 1);
}

TEST(TimeSync, EveryOptionHasItsEffect) {
  const auto run = [](const std::string& options) {
    auto t = std::make_unique<Trial>();
    t->made_survey();
    t->set(options);
    t->go();
    return t;
  };
  const auto normal = run("{}");
  EXPECT_EQ(run(R"({"model": "literal"})")->context.records.find<core::EventData>()->sigma[0], 0);
  EXPECT_EQ(run(R"({"convergence": "fixed"})")->tally.of("events before the clock had settled"), 2u);
  EXPECT_EQ(run(R"({"convergence": "fixed", "convergence_time": "2000 s"})")->tally.of("events before the clock had settled"), 4u);
  EXPECT_EQ(run(R"({"max_gap": "15 s"})")->tally.of("events outside the clock's log"), 20u);
  EXPECT_GT(run(R"({"tag_sigma": "50 us"})")->context.records.find<core::EventData>()->sigma[0], 5e-5);
  EXPECT_EQ(run(R"({"technique": "marks"})")->context.records.find<core::EventData>()->size(), 20u);
  EXPECT_EQ(run(R"({"match": "time"})")->trusted("n"), 17);
  EXPECT_EQ(run(R"({"tolerance": "1 us"})")
                ->findings.find("comparisons")
                ->items()[0]
                .find("before_correction")
                ->find("seconds")
                ->find("n")
                ->as_int(),
            0);
  const auto renamed = run(R"({"file": "x.csv"})");
  EXPECT_TRUE(fs::exists(renamed->context.output / "x.csv"));
  EXPECT_FALSE(fs::exists(renamed->context.output / "events_time.csv"));
  EXPECT_EQ(normal->findings.find("comparisons")->items()[0].find("metres"), nullptr);
}

TEST(TimeSync, FaultsOfTheSurveyAreToldBeforeAnyFileIsRead) {
  Trial none;
  EXPECT_NE(none.refusal().find("no [[event]]"), std::string::npos);
  Trial clock;
  clock.made_survey();
  clock.survey.clock.clear();
  EXPECT_NE(clock.refusal().find("no [[clock]]"), std::string::npos);
  Trial names;
  names.made_survey();
  names.survey.events[1].technique = "pc";
  EXPECT_NE(names.refusal().find("two files"), std::string::npos);
  Trial technique;
  technique.made_survey();
  technique.set(R"({"technique": "camera"})");
  EXPECT_NE(technique.refusal().find("camera"), std::string::npos);
}

TEST(TimeSync, MarksAloneNeedNoClock) {
  Trial t;
  t.events("marks.csv", "t,id,strip\n10,a,1\n20,b,1\n", core::TimeScale::gps_week).latency = core::Seconds(0.25);
  t.go();
  EXPECT_EQ(t.context.records.get<core::EventData>().time[0], 1525 * 604800.0 + 10.25);
  EXPECT_EQ(t.findings.find("comparisons"), nullptr);
  EXPECT_FALSE(fs::exists(t.context.output / "time_sync.png"));
}

TEST(TimeSyncReference, TheReferenceFlightFromItsFiles) {
  SWATH_SHARED_OR_SKIP(folder, "vectors");
  const core::Value d = io::read_value_file(folder / "p003_sync.json");
  for (const char* model : {"literal", "robust"}) {
    Trial t;
    std::string stamps = "id,strip,t\n", marks = stamps;
    char line[80];
    const auto& events = d.find("events")->items();
    for (size_t i = 0; i < events.size(); ++i) {
      const auto strip = static_cast<int>(events[i].find("strip")->as_int());
      std::snprintf(line, sizeof line, "%zu,%d,%.7f\n", i, strip, events[i].find("pc_utc_sec_of_day")->as_number());
      stamps += line;
      std::snprintf(line, sizeof line, "%zu,%d,%.7f\n", i, strip, events[i].find("mark_gps_sow")->as_number());
      marks += line;
    }
    t.events("pc.csv", stamps, core::TimeScale::utc_day).computer_clock = true;
    t.events("marks.csv", marks, core::TimeScale::gps_week);
    t.survey.clock.push_back({folder / "p003_loopstats.csv", io::ClockFormat::loopstats});
    t.set(std::string(R"({"model": ")") + model + R"("})");
    t.go();
    EXPECT_EQ(t.tally.of("events before the clock had settled"), 22u) << "the first strip";
    EXPECT_EQ(t.trusted("n"), 38);
    EXPECT_LT(t.trusted("largest"), 40e-6);
    std::printf("%s: bias %.2f us, rms %.2f us, largest %.2f us\n", model, t.trusted("bias") * 1e6, t.trusted("rms") * 1e6,
                t.trusted("largest") * 1e6);
    if (std::string(model) == "robust") continue;
    EXPECT_NEAR(t.trusted("largest"), d.find("stats")->find("corrected_max_after_convergence_us")->as_number() * 1e-6, 1e-7);
    for (size_t i = 0; i < events.size(); ++i)
      EXPECT_NEAR(t.context.records.get<core::EventData>().time[i] - 1525 * 604800.0, events[i].find("corrected_gps_sow")->as_number(),
                  1e-7)
          << i;
  }
}

}  // namespace
}  // namespace swath::stages
