// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/navigation/exposures.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace swath::calib {
namespace {

struct Flown {
  core::EventData events;
  std::vector<io::SurveyCamera> cameras;
  std::vector<io::ListedImage> listed;
  std::vector<io::LineWindow> lines;

  void expose(const std::string& id, double time, const std::string& technique = "marks", int strip = 1) {
    events.time.push_back(time), events.sigma.push_back(1e-6), events.id.push_back(id), events.strip.push_back(strip);
    events.technique.push_back(technique), events.doubtful.push_back(0);
  }
  void mount(const std::string& name, const std::string& technique = {}) {
    cameras.emplace_back().name = name;
    cameras.back().technique = technique;
  }
  void list(const std::string& name, const std::string& event, std::optional<std::string> camera = {}, std::optional<int> strip = {}) {
    listed.push_back({name, event, std::move(camera), strip, "images.csv:" + std::to_string(listed.size() + 2)});
  }
  Exposures found() const { return exposures_of(events, cameras, listed, lines, "flight"); }
  std::string fault() const {
    try {
      found();
    } catch (const core::Error& e) {
      return e.text();
    }
    return {};
  }
  void expect_fault(const std::string& words) const { EXPECT_NE(fault().find(words), std::string::npos) << fault(); }
};

TEST(Exposures, WithoutAListEachEventOfTheTechniqueIsAnImage) {
  Flown f;
  f.mount("P1", "marks");
  f.expose("2", 20.0), f.expose("1", 10.0), f.expose("1", 10.1, "pc"), f.expose("3", 35.0, "marks", 0), f.expose("4", 50.0, "marks", 0);
  f.lines = {{7, 30.0, 40.0}};
  const Exposures e = f.found();
  ASSERT_EQ(e.images.size(), 4u);
  EXPECT_EQ(e.images[0].name + e.images[1].name + e.images[2].name, "123");
  EXPECT_EQ(e.images[1].strip, 1);
  EXPECT_EQ(e.images[2].strip, 7) << "of the flight line";
  EXPECT_EQ(e.images[3].strip, 0) << "in no line";
  EXPECT_EQ(e.events_left_out, 0u);
}

TEST(Exposures, AListNamesImagesCamerasAndStrips) {
  Flown f;
  f.mount("left", "a"), f.mount("right", "b");
  f.expose("1", 10.0, "a"), f.expose("1", 10.2, "b"), f.expose("2", 12.0, "a"), f.expose("2", 12.2, "b");
  f.list("R2.jpg", "2", "right"), f.list("L1.jpg", "1", "left", 4), f.list("R1.jpg", "1", "right");
  const Exposures e = f.found();
  ASSERT_EQ(e.images.size(), 3u);
  EXPECT_EQ(e.images[0].name, "L1.jpg");
  EXPECT_EQ(e.images[0].strip, 4);
  EXPECT_EQ(e.images[1].name, "R1.jpg");
  EXPECT_EQ(e.images[1].camera, 1u);
  EXPECT_EQ(e.images[1].time, 10.2);
  EXPECT_TRUE(e.images[0].event == 0u && e.images[1].event == 1u);
  EXPECT_EQ(e.images[2].strip, 1);
  EXPECT_EQ(e.events_left_out, 1u);
}

TEST(Exposures, WhatCannotBeToldApartIsNamed) {
  Flown f;
  f.mount("P1");
  f.expose("1", 10.0), f.expose("1", 10.1, "pc");
  f.expect_fault("of several techniques, and camera P1 states none: marks, pc");
  f.cameras[0].technique = "mark";
  f.expect_fault("no event is of the technique mark of camera P1");
  f.cameras[0].technique = "marks";
  EXPECT_EQ(f.fault(), "");
  f.expose("1", 11.0);
  f.expect_fault("image 1 is there twice: two events of camera P1 have this id");
  f.list("a.jpg", "1");
  f.expect_fault("image a.jpg is of event 1, and 2 events of the technique marks have that id");
  f.listed.clear();
  f.mount("P2", "marks");
  f.expect_fault("cameras P1 and P2 have the same events");
}

TEST(Exposures, MistakesOfTheListAreNamedWithTheirLine) {
  Flown f;
  f.mount("P1");
  f.expose("1", 10.0), f.expose("2", 12.0);
  f.list("a.jpg", "1"), f.list("a.jpg", "2");
  f.expect_fault("image a.jpg is there twice, first in images.csv:2");
  f.listed[1].name = "b.jpg";
  EXPECT_EQ(f.fault(), "");
  f.listed[1].event = "1";
  f.expect_fault("images a.jpg and b.jpg are of one event, 1");
  f.listed[1].event = "3";
  f.expect_fault("image b.jpg is of event 3, and no event of the technique marks has that id");
  EXPECT_NE(f.fault().find("images.csv:3"), std::string::npos) << f.fault();
  f.listed[1] = {"b.jpg", "2", "P2", {}, "images.csv:3"};
  f.expect_fault("camera P2 of image b.jpg is not in the survey");
  f.mount("P2");
  f.expect_fault("several cameras, and the list does not say which took image a.jpg");
}

}  // namespace
}  // namespace swath::calib
