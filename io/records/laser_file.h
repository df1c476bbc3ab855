// SPDX-License-Identifier: GPL-3.0-or-later
// Raw laser records as shots: one flight line of one file at a time, streamed.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/report.h"
#include "core/shot.h"
#include "core/time.h"
#include "io/records/laser_records.h"

namespace swath::io {

/// One flight line of one laser file.
struct StripInfo {
  size_t file = 0;          ///< index in the survey's [[laser]]
  int line = 0;             ///< flight line id
  std::uint64_t first = 0;  ///< rows [first, last) of the file hold all its records (and may hold others' in between)
  std::uint64_t last = 0;
  std::uint64_t records = 0;                                   ///< rows of its own
  double first_time = 0, last_time = 0;                        ///< GPS time of its first and last record (NaN: no record has a time)
  LaserPlace begin;                                            ///< of row `first`
  core::TimeReader clock;                                      ///< as it stands at row `first` (which it may be asked again)
  std::shared_ptr<const std::vector<std::uint64_t>> bad = {};  ///< rows of the file that are left out, ascending

  std::string name(const Survey& survey) const;  ///< "line 3 of flight.las"
};

/// The strips of a laser file by their first row. The line of a record is, in this order: the file's column of lines; the id stated for the
/// file; the [[line]] whose time window holds it; the point source id (LAS); the file's number, from 1. Where the survey has [[line]]s,
/// records outside the window of their line, or of a line that is not listed, are counted as outside every line.
/// Left out and counted: records whose time is missing, outside its scale or over an hour from those around it, and line ids that are no
/// whole number from 0 to 65535. Throws Error naming the first where they are not few.
std::vector<StripInfo> scan(const Survey& survey, size_t file, core::Tally& tally);
/// Of all files, in the order of the survey. Counts lines of which the last or first records seem to be missing: the records end long
/// before the line does by its stated times, while those of other lines do not.
std::vector<StripInfo> scan(const Survey& survey, core::Tally& tally);

/// Streams the shots of one strip in the order they were recorded; any number of strips may be streamed at once, each by its own object.
class LaserSource {
 public:
  /// The survey must outlive the object.
  LaserSource(const Survey& survey, const StripInfo& strip);
  ~LaserSource();
  LaserSource(LaserSource&&) noexcept;
  LaserSource& operator=(LaserSource&&) noexcept;

  int line() const;
  /// The next shots, about `most`: returns of one time are not parted, up to 255 more than `most`. False at the end, with an empty batch.
  /// Kept out and counted with first examples: range not positive or over 100 km, a range or angle that is missing, not finite or (angle)
  /// beyond a full turn; throws core::Error with the record where the latter are not few, and for a time that goes back. Counted and set to
  /// unknown: return numbers that are none; cut to their field: intensities. Throws Error naming the record where time goes back inside the
  /// line.
  bool next(core::Shots& batch, size_t most);
  /// What was counted up to now.
  const core::Tally& tally() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace swath::io
