// SPDX-License-Identifier: GPL-3.0-or-later
// Which events are which images: names, cameras and strips of the exposures of a flight.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/records/event_data.h"
#include "io/images/image_list.h"
#include "io/survey/camera_file.h"
#include "io/survey/survey.h"

namespace swath::calib {

struct Exposure {
  std::string name;
  std::uint32_t camera = 0;
  int strip = 0;
  double time = 0.0, sigma = 0.0;  ///< GPS time, s
  bool doubtful = false;
  std::optional<size_t> event{};  ///< number of its event: cameras with one trigger share it
};

struct Exposures {
  std::vector<Exposure> images;  ///< by time
  size_t events_left_out = 0;    ///< of the cameras' techniques, that the lists do not name
};

/// Throws core::Error where camera `c` states a technique that no event is of.
void expect_technique(const io::SurveyCamera& c, const std::set<std::string>& techniques, const std::string& survey);

/// Without a list each event of a camera's technique is an image of the event's id. Strips: as listed, else the event's, else that of the
/// flight line. Throws core::Error: an image or an event that is there twice, a camera or an event that is not there, events of several
/// techniques where a camera states none, cameras with the same events.
Exposures exposures_of(const core::EventData& events, const std::vector<io::SurveyCamera>& cameras,
                       const std::vector<io::ListedImage>& listed, const std::vector<io::LineWindow>& lines, const std::string& survey);

}  // namespace swath::calib
