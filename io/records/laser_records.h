// SPDX-License-Identifier: GPL-3.0-or-later
// Laser records of every format as columns of numbers, as they were recorded: the door behind LaserSource.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/report.h"
#include "io/survey/survey.h"

namespace swath::io {

/// A place between records of a laser file.
struct LaserPlace {
  std::uint64_t record = 0;  ///< row in the file of the next record, from 0
  std::uint64_t byte = 0;    ///< text: first byte of its line
  std::uint64_t line = 0;    ///< text: number of its line, from 1; 0: the place is the start of the file
};

/// Records as recorded, in the file's units, one entry per return, in file order. Columns that the file does not have are empty.
struct LaserRecords {
  std::vector<std::uint64_t> record;  ///< row in the file (CSD: pulse)
  std::vector<double> time;           ///< in the file's scale
  std::vector<double> week;           ///< GPS week, where it has a column
  std::vector<double> line;           ///< flight line id, where it has a column (LAS: point source id)
  std::vector<double> angle, range;   ///< file's units; either these
  std::vector<double> x, y, z;        ///< ... or these: forward, right, nadir
  std::vector<double> intensity, return_number, return_count;
  std::vector<std::uint16_t> flags;            ///< core::flag
  std::vector<std::uint64_t> byte, text_line;  ///< text files read for `Wanted::plan`: where each record stands

  size_t size() const { return time.size(); }
  void clear();
};

/// `plan`: time, week and line alone; `all`: every column the survey names.
enum class Wanted { plan, all };

/// Streams records of one laser file.
class LaserRecordReader {
 public:
  virtual ~LaserRecordReader() = default;
  /// Replaces `out` by the next records, about `most` (a CSD pulse is not cut); false at the end.
  virtual bool next(LaserRecords& out, size_t most) = 0;
  /// Record `i` of the last next() is one of those that are looked for.
  virtual void take(size_t /*i*/) {}
  /// Counts what is odd of the records taken so far; `name`: of the file.
  virtual void count_oddities(const std::string&, core::Tally&) const {}
};

/// Opens a file of the survey at `from`; records from row `end` on are not read. Throws Error: missing column or field, wrong format.
std::unique_ptr<LaserRecordReader> open_laser_records(const Survey& survey, const LaserFile& file, Wanted wanted,
                                                      const LaserPlace& from = {}, std::uint64_t end = ~std::uint64_t{0});

/// The time scale of a laser file: the survey's; where it states none, the one that a CSD (week in its header) or LAS file (adjusted
/// standard GPS time by its global encoding) states itself. Throws Error where a LAS file counts seconds of week and no week is stated.
TimeTags time_of(const Survey& survey, const LaserFile& file);

}  // namespace swath::io
