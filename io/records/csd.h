// SPDX-License-Identifier: GPL-3.0-or-later
// Optech CSD (ALTM corrected sensor data): ranges, scan angle and the carrier's pose of every pulse.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/config/units.h"
#include "core/records/sensor.h"
#include "core/records/trajectory_data.h"
#include "core/report.h"
#include "io/text/binary_file.h"

namespace swath::io {

struct CsdHeader {
  std::string vendor, software;
  float format_version = 0;
  int gps_week = 0;
  double first_time = 0, last_time = 0;  ///< seconds of week
  std::uint32_t records = 0;
  int strips = 0;
  std::array<double, 3> misalignment{};  ///< roll, pitch, heading, rad
  std::array<double, 3> imu_offset{};    ///< roll, pitch, heading, rad; added to the misalignment
  double temperature = 0;                ///< degrees Celsius
  double pressure = 0;                   ///< mbar
};

/// One pulse. Angles rad, lengths m.
struct CsdPulse {
  double time = 0;       ///< as recorded: seconds of week
  int return_count = 0;  ///< 0 to 4
  std::array<float, 4> range{};
  std::array<std::uint16_t, 4> intensity{};
  float scan_angle = 0;                    ///< positive to starboard
  float roll = 0, pitch = 0, heading = 0;  ///< conventions of the project
  double latitude = 0, longitude = 0;      ///< longitude brought to (-pi, pi]
  float height = 0;                        ///< ellipsoidal
};

/// The boresight that the header states: misalignment + IMU offset, per angle. The vendor's axes are x right, y forward, z up and its
/// rotation R3(heading) R1(-pitch) R2(-roll); in x forward, y right, z down that is Rz(heading) Ry(pitch) Rx(roll).
core::Calibration calibration_of(const CsdHeader& header);

/// Streams the pulses of a file. Throws Error: wrong signature, truncated (byte), a return count over 4 (record).
class CsdReader {
 public:
  explicit CsdReader(const std::filesystem::path& file);
  const std::filesystem::path& path() const { return file_.path(); }
  const CsdHeader& header() const { return header_; }
  std::uint64_t pulses() const { return pulses_; }
  /// Pulses [first, first + n); they must exist.
  void read(std::uint64_t first, size_t n, std::vector<CsdPulse>& pulses);

 private:
  BinaryFile file_;
  CsdHeader header_;
  std::uint64_t pulses_ = 0;
  std::vector<unsigned char> bytes_;
};

/// Throws Error where the header states another GPS week than `week`, as the survey does. A header below 1024 may have rolled over.
void hold_csd_week(const std::filesystem::path& file, int week);

/// The carrier's poses that the file holds, at least `spacing` apart (0: one per pulse), the last one always. Times as recorded
/// (seconds of week). Poses at a repeated time are counted and left out; one that is not finite is an error.
/// Throws Error naming the record where time goes back (a drop of over half a week is the week's roll-over and is followed).
core::TrajectoryData read_csd_trajectory(CsdReader& file, core::Seconds spacing, core::Tally& tally);

}  // namespace swath::io
