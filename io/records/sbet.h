// SPDX-License-Identifier: GPL-3.0-or-later
// SBET trajectories (17 little-endian doubles per record) and their accuracies, smrmsg (10 doubles).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/records/trajectory_data.h"
#include "core/report.h"
#include "io/survey/survey.h"
#include "io/text/binary_file.h"

namespace swath::io {

/// One record as stored. Angles rad, lengths m, velocities m/s in the wander frame, accelerations m/s2 and rates rad/s in `body`.
struct SbetRecord {
  double time, latitude, longitude, altitude, x_velocity, y_velocity, z_velocity, roll, pitch, platform_heading, wander_angle;
  std::array<double, 3> acceleration, angular_rate;
};

/// One record as stored: sigmas of position (m) and velocity (m/s) north, east, down; of roll, pitch, heading in arc minutes.
struct SmrmsgRecord {
  double time;
  std::array<double, 3> position, velocity, attitude;
};

constexpr size_t sbet_bytes = 136, smrmsg_bytes = 80;

/// Rows of doubles, all there is to both formats. Throws Error: empty, or a size that is no whole number of records (byte).
template <class Record>
class RecordFile {
 public:
  explicit RecordFile(const std::filesystem::path& file);
  std::uint64_t records() const { return file_.size() / sizeof(Record); }
  void read(std::uint64_t first, size_t n, std::vector<Record>& out) const;

 private:
  BinaryFile file_;
};
using SbetFile = RecordFile<SbetRecord>;
using SmrmsgFile = RecordFile<SmrmsgRecord>;

/// A whole SBET in GPS time, heading = platform heading - wander angle (`wander`, otherwise the heading as it stands), velocities turned
/// to north, east, down. `axes` automatic: those axes whose velocities agree with the positions to 0.5 m/s + 2 % of the speed in the
/// mean; where none does, velocities are left out and counted. Sigmas from `accuracy`, linear in time; the nearest record outside its
/// span, which is counted. Throws Error naming the record: a value not finite, a latitude beyond 90 deg (angles in degrees?).
core::TrajectoryData read_sbet(const std::filesystem::path& file, const TimeTags& time, bool wander, VelocityAxes axes,
                               const std::optional<std::filesystem::path>& accuracy, core::Tally& tally);

/// Writes an SBET in seconds of the week of the first record (counting on past the week's end): wander angle 0, velocities north, west, up
/// (as the vendor's files have them), from positions where the trajectory has none; accelerations and rates 0.
void write_sbet(const std::filesystem::path& file, const core::TrajectoryData& trajectory);
/// Writes the sigmas; those of velocity from the covariance series, 0 (unknown) where there is none. The trajectory must have sigmas.
void write_smrmsg(const std::filesystem::path& file, const core::TrajectoryData& trajectory);

}  // namespace swath::io
