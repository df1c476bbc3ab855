// SPDX-License-Identifier: GPL-3.0-or-later
// What a RINEX observation file (versions 2, 3 and 4) shows before its measurements are used: station, antenna, epochs.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace swath::io {

enum class RinexKind { observations, navigation, clocks, orbits, other };

struct RinexHeader {
  double version = 0;
  char system = 'G';                                         ///< as in the first line: G, R, E, C, J, I, S, or M (mixed)
  std::string marker;                                        ///< name of the station
  std::optional<Eigen::Vector3d> position;                   ///< approximate, ecef, m; none where the header has none, or one off the Earth
  std::string antenna_type;                                  ///< with its radome, "TRM29659.00     NONE"
  Eigen::Vector3d antenna_offset = Eigen::Vector3d::Zero();  ///< marker to the antenna's reference point: east, north, up, m
  std::optional<double> interval;                            ///< as stated, s
};

struct RinexObservations {
  RinexHeader header;
  double first = 0, last = 0;  ///< GPS time of the first and the last epoch, s
  std::uint64_t epochs = 0;
  double interval = 0;       ///< median step between epochs, s; 0 with one epoch
  double longest_gap = 0;    ///< longest step between epochs, s
  std::uint64_t events = 0;  ///< epochs of flag 5
};

/// An epoch of flag 5, an external event, as GPS time; whole seconds and their fraction apart.
struct RinexEvent {
  double second = 0.0, fraction = 0.0;
};

/// What the file is by its first line (orbits: SP3); `other` where that is not understood. Throws Error where it cannot be read.
RinexKind rinex_kind(const std::filesystem::path& file);

/// Reads the header and the time of every epoch, whatever its time system; measurements are passed over. Throws Error: no RINEX observation
/// file, compressed, a version below 2, no end of header, a field that is no number, an epoch that is not understood (file:line), no epoch.
RinexObservations scan_rinex(const std::filesystem::path& file);

/// The external events of an observation file, in its order. Throws Error as scan_rinex does, but not where there is no epoch.
std::vector<RinexEvent> rinex_events(const std::filesystem::path& file);

}  // namespace swath::io
