// SPDX-License-Identifier: GPL-3.0-or-later
// Base stations for raw GNSS observations: what a survey says of them, and which are of use.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/report.h"
#include "io/gnss/rinex_header.h"
#include "io/gnss/rtklib_config.h"
#include "io/survey/survey.h"

namespace swath::io {

/// Observations of one receiver in one or several files.
struct Receiver {
  std::vector<std::filesystem::path> files;
  RinexHeader header;  ///< of the first file; position and antenna of the first that states them
  double first = std::numeric_limits<double>::infinity(), last = -std::numeric_limits<double>::infinity();
  double interval = 0;
  std::uint64_t epochs = 0;
};

/// Looks through all files of a receiver; throws core::Error.
Receiver scan_receiver(const Survey& survey, const std::vector<std::filesystem::path>& files);

struct Base {
  std::string name, file_name;
  Receiver receiver;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  RtklibAntenna antenna;
  double distance = 0;  ///< from the rover's approximate position, m
  double overlap = 0;   ///< s of the rover's span; below 0: none

  double share_of(const Receiver& rover) const { return rover.last > rover.first ? overlap / (rover.last - rover.first) : 1.0; }
};

/// The name of an antenna in the antenna file: of the stated type, or with "*" of the RINEX header's; empty where none is stated.
std::string antenna_type(const std::optional<std::filesystem::path>& antenna_file, const std::string& stated, const Receiver& receiver,
                         const std::string& whose);

/// The survey's bases, nearest to `place` (ecef) first. Throws core::Error where a file cannot be read or a base has no position.
std::vector<Base> read_bases(const Survey& survey, const Receiver& rover, const Eigen::Vector3d& place, core::Tally& tally);

/// Why each of the bases, nearest first, is not used: empty for at most `most` of them within `farthest` (m) that record while the rover
/// does. Throws core::Error with distances, or times, where none is left.
std::vector<std::string> reasons_against(const std::vector<Base>& bases, const Receiver& rover, double farthest, size_t most);

}  // namespace swath::io
