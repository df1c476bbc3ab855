// SPDX-License-Identifier: GPL-3.0-or-later
// NMEA 0183 sentences of a GNSS receiver.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/records/gnss_data.h"
#include "core/report.h"
#include "io/survey/navigation.h"

namespace swath::io {

/// A position as a GGA sentence states it, with the sigmas of a GST sentence of the same second where there is one.
struct NmeaFix {
  double of_day = 0;                               ///< UTC, s since midnight
  double latitude = 0, longitude = 0, height = 0;  ///< deg, deg, ellipsoidal m (height above the geoid + its separation)
  int quality = 0;                                 ///< 1 single, 2 differential, 3 PPS, 4 fixed, 5 float, 9 SBAS
  double satellites = 0;
  double sigma_north, sigma_east, sigma_up;  ///< m; NaN without GST
  std::uint64_t line = 0;
  std::size_t date = 0;  ///< index of the date sentence nearest in the file; none: dates.size()
};

/// A UTC instant as RMC or ZDA state it.
struct NmeaDate {
  double midnight = 0;  ///< POSIX seconds
  double of_day = 0;
};

/// The content of a file.
struct NmeaFile {
  std::vector<NmeaFix> fixes;
  std::vector<NmeaDate> dates;
  std::map<std::string, std::uint64_t> sentences;  ///< by kind ("GGA"), with a right checksum
};

/// True where the file's first 64 KiB hold a NMEA sentence with a right checksum.
bool looks_like_nmea(const std::filesystem::path& file);

/// Reads GGA, RMC, ZDA and GST of any talker, wherever they stand in a line. Left out and counted: sentences with a wrong checksum or
/// none, lines that hold no sentence (binary data, text; comments with # are passed over), positions without a solution, estimated,
/// entered by hand or simulated (quality 0, 6, 7, 8), those of a second talker at the time of the one before, and those without a geoid
/// separation, whose ellipsoidal height is not known.
NmeaFile scan_nmea(const std::filesystem::path& file, core::Tally& tally);

/// The positions on GPS time. The day of a position is that of the nearest RMC (status A) or ZDA sentence, midnight between them followed;
/// without any it is `time.date` of the first position, and midnight is followed. A stated `time.date` that lies a multiple of 1024 weeks
/// from the file's is right (receivers whose week rolled over): the times are moved and that is counted. Two-digit years are 1980 to 2079.
/// Sigmas come from GST, else by quality (FixList). Velocities are not taken: RMC and VTG have no vertical one and are smoothed by the
/// receiver. Throws Error: no date, a stated date that is another, and what FixList throws.
core::GnssData read_nmea(const std::filesystem::path& path, const GnssFile& file, double latency, core::Tally& tally);

}  // namespace swath::io
