// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>

#include "core/time.h"
#include "io/survey/survey.h"
#include "simulate/options.h"
#include "simulate/shoot.h"

namespace swath::simulate {

/// A recorded time in a scale: gps_week and utc_day begin anew at the end of the week or day.
double time_in(core::TimeScale scale, core::GpsTime t);

/// The tags that survey.toml needs for a file in a scale whose first record is at `first`.
io::TimeTags tags_of(core::TimeScale scale, core::GpsTime first);

/// One file of raw laser records, written batch by batch; it appears whole with finish().
class LaserFileWriter {
 public:
  virtual ~LaserFileWriter() = default;
  virtual void append(const Returns& returns) = 0;
  virtual void finish() = 0;
};

/// The name of the file in the survey's folder.
std::filesystem::path laser_name(Format format);

std::unique_ptr<LaserFileWriter> open_laser_file(const std::filesystem::path& folder, Format format, const Options& options);

/// What survey.toml says of that file.
io::LaserFile describe_laser_file(Format format, const Options& options, core::GpsTime first);

/// truth/returns.npy: t (GPS time, s), X Y Z (ECEF, m), e n h (map, m), range (m), angle (a', rad), bx by bz (unit beam, scanner frame),
/// cls, rn, nr, line.
class TruthFile {
 public:
  explicit TruthFile(const std::filesystem::path& file);
  ~TruthFile();
  void append(const Returns& returns);
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace swath::simulate
