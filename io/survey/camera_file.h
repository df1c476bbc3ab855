// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of survey.toml that describe images: cameras, and lists of the images that events are.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "core/config/option.h"
#include "core/records/camera.h"

namespace swath::io {

struct SurveyCameraSigmas : core::CameraSigmas {
  SurveyCameraSigmas() = default;
  std::string lever_arm = "held";
};

template <class V>
void describe(SurveyCameraSigmas& s, V& v) {
  describe(static_cast<core::CameraSigmas&>(s), v);
  v.option("lever_arm", s.lever_arm, "\"held\", \"free\", or a sigma of each coordinate of lever_arm: \"2 cm\".");
}

/// A camera on the carrier.
struct SurveyCamera : core::FrameCamera {
  SurveyCamera() = default;
  std::array<core::Metres, 3> lever_arm{};
  std::string technique;
  SurveyCameraSigmas sigma;
};

template <class V>
void describe(SurveyCamera& c, V& v) {
  describe(static_cast<core::FrameCamera&>(c), v);
  v.option("lever_arm", c.lever_arm, "IMU centre to perspective centre: forward, right, down.", "conventions");
  v.option("technique", c.technique, "Technique of the events that are its exposures; needed where the survey has several.");
  v.table("sigma", c.sigma, "Which values are held, free, or observed.");
}

/// A table of images: which event each of them is.
struct ImageListFile {
  std::filesystem::path file;
  std::string name = "name", event = "event", camera = "camera", strip = "strip";
};

template <class V>
void describe(ImageListFile& f, V& v) {
  v.option("file", f.file, "Table of images, relative to survey.toml; without one each event is an image of its own id.");
  v.option("name", f.name, "Column of the images' names, as the image points have them.");
  v.option("event", f.event, "Column of the event's id.");
  v.option("camera", f.camera, "Column of the camera's name, where the table has it.");
  v.option("strip", f.strip, "Column of the strip's number, where the table has it; else that of the event.");
}

}  // namespace swath::io
