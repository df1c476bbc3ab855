// SPDX-License-Identifier: GPL-3.0-or-later
// Events as receivers and cameras record them, with a time scale of their own: u-blox, NovAtel, DJI and RINEX.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "core/report.h"
#include "io/survey/navigation.h"

namespace swath::io {

/// One event in GPS time; whole seconds and their fraction apart, since together they do not fit a double to better than 0.24 us.
struct EventMark {
  double second = 0.0, fraction = 0.0;  ///< s
  double sigma = 0.0;                   ///< of the time, s; 0: not stated
  std::string id;
  bool doubtful = false;                                   ///< the recorder's clock had no fix of GPS time
  Eigen::Vector3d place = Eigen::Vector3d::Constant(NAN);  ///< of the antenna as the recorder states it, ecef, m; NaN: none
  Eigen::Vector3d place_sigma = Eigen::Vector3d::Zero();   ///< north, east, down, m
};

/// What a file is: by its name's ending (.ubx, .mrk, .obs, .rnx, .18o), its first bytes (UBX, #MARK...A, RINEX), else text.
EventFormat event_format(const std::filesystem::path& file);
/// The stated format, or that of the file at `path`.
inline EventFormat format_of(const EventFile& file, const std::filesystem::path& path) {
  return file.format == EventFormat::automatic ? event_format(path) : file.format;
}

/// UBX-TIM-TM2 messages (u-blox M8 and F9 interface descriptions) among any others. One event per new edge; the id is the counter of
/// rising edges. Counted: damaged messages, edges whose time is not valid (left out), edges that the counter says were lost, edges by the
/// receiver's own clock or without a GNSS fix of time (doubtful). Throws Error where there is no message of UBX, or none with an event.
std::vector<EventMark> read_ubx_marks(const std::filesystem::path& file, EventEdge edge, int input, core::Tally& tally);

/// ASCII logs MARKTIME and MARK1TIME to MARK4TIME (NovAtel OEM7 Commands and Logs), among any others. The receiver clock's offset is taken
/// off. `input`: 1 to 4; 0: all. Counted: lines whose CRC or fields are wrong (left out), marks whose clock model is not VALID (doubtful).
/// Throws Error where there is no mark.
std::vector<EventMark> read_novatel_marks(const std::filesystem::path& file, int input, core::Tally& tally);

/// Timestamp.MRK of DJI's RTK drones: photo, seconds of week, [week], antenna to camera N, E, V (mm), latitude, longitude, ellipsoidal
/// height of the camera, sigmas, quality. The place is given for the antenna, without those offsets. Throws Error "file:line" for a line
/// that is not one, and where there is none. Photos without a position (quality 0) are doubtful.
std::vector<EventMark> read_mrk(const std::filesystem::path& file, core::Tally& tally);

/// Epochs of RINEX observations with flag 5 (external event), several in a row too; in the file's time system, as GPS time.
std::vector<EventMark> read_rinex_marks(const std::filesystem::path& file);

/// By the file's format, which is none of text's.
std::vector<EventMark> read_marks(const std::filesystem::path& path, const EventFile& file, EventFormat format, core::Tally& tally);

}  // namespace swath::io
