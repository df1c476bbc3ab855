// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/line_checks.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "core/config/units.h"
#include "io/survey/wild_records.h"

namespace swath::io {
namespace {

std::string name_of(std::size_t line) { return "line[" + std::to_string(line + 1) + "]"; }

/// What to do about a line that does not end after it starts.
std::string hint_of_end(const Survey& survey) {
  const std::string hours = core::format_number(longest_crossing / 3600.0);
  if (period_of(survey.line_time.scale) > 0.0)
    return "start and end exchanged? A line that crosses the end of the GPS week, or midnight UTC, may last " + hours + " h at most";
  return "start and end exchanged? Only seconds of the week or of the day (line_time.scale gps_week or utc_day) begin anew";
}

}  // namespace

std::vector<LineFault> line_faults(const Survey& survey) {
  const std::vector<FlightLine>& lines = survey.lines;
  std::vector<LineFault> out;
  std::map<int, std::size_t> ids;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto [first, fresh] = ids.try_emplace(lines[i].id, i);
    if (!fresh) out.push_back({i, "id", "id " + std::to_string(lines[i].id) + " is taken by " + name_of(first->second) + " already"});
    if (!(seconds_of(survey, lines[i]) > 0.0)) out.push_back({i, "end", "the line must end after it starts", hint_of_end(survey)});
  }
  std::vector<std::size_t> order(lines.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return lines[a].start < lines[b].start; });
  for (std::size_t k = 1; k < order.size(); ++k)
    if ((lines[order[k]].start - lines[order[k - 1]].start).value < seconds_of(survey, lines[order[k - 1]]))
      out.push_back({order[k], "start", "the line starts before " + name_of(order[k - 1]) + " ends"});
  const double period = period_of(survey.line_time.scale);
  for (std::size_t i = 0; period > 0.0 && i < lines.size(); ++i)  // beyond the end of the week or the day
    for (std::size_t j = i + 1; j < lines.size(); ++j)
      if (lines[j].start.value + period < lines[i].start.value + seconds_of(survey, lines[i]))
        out.push_back({j, "start", "the line starts before " + name_of(i) + " ends"});
  return out;
}

}  // namespace swath::io
