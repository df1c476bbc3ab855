// SPDX-License-Identifier: GPL-3.0-or-later
// The times of laser records among one another: impossible ones, and lines whose records end too early.
#pragma once

#include <memory>
#include <vector>

#include "core/report.h"
#include "io/records/laser_records.h"
#include "io/survey/survey.h"

namespace swath::io {

/// Streams records and marks those whose time lies over an hour from most of those around them in the file.
class LaserTimes {
 public:
  LaserTimes(std::unique_ptr<LaserRecordReader> reader, const TimeTags& tags) : reader_(std::move(reader)), tags_(tags) {}
  /// Replaces `out` and the marks, one per record; false at the end.
  bool next(LaserRecords& out, std::vector<std::uint8_t>& wild, size_t most);

 private:
  double seconds(const LaserRecords& r, size_t i) const;
  std::unique_ptr<LaserRecordReader> reader_;
  TimeTags tags_;
  LaserRecords ahead_;
  bool begun_ = false, has_ahead_ = false;
  std::vector<double> before_;  ///< times of the records before
};

/// First and last time of records of a line.
struct LineSpan {
  int line = 0;
  double first = 0, last = 0;
};

/// Counts lines without a record, and those whose records begin long after or end long before the line does by its stated times: by over
/// 1 % of it and 0.1 s, and over four times what is usual at the ends of the survey's lines.
void count_cut_lines(const std::vector<LineWindow>& windows, const std::vector<LineSpan>& spans, core::Tally& tally);

}  // namespace swath::io
