// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/event_file.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/time.h"
#include "io/records/event_marks.h"
#include "io/records/repeated_times.h"
#include "io/survey/wild_records.h"
#include "io/text/data_lines.h"
#include "io/text/delimited.h"
#include "io/text/line_reader.h"

namespace swath::io {
namespace {

/// The lines of data as texts, since ids need not be numbers; `layout` gets the delimiter and the names of the columns.
std::vector<DataLine> rows_of(const std::filesystem::path& path, const EventFile& file, DelimitedLayout& layout) {
  std::vector<DataLine> out;
  bool first = true;
  std::string comment;  // the last one before the data: it may hold the names
  const auto parted_by = [&](const std::string& line) {
    return layout.delimiter = file.delimiter.empty() ? delimiter_in(line) : delimiter_from(file.delimiter, path);
  };
  const auto take = [&](DataLine& line) {
    if (std::exchange(first, false)) {
      layout.columns = line.fields.size();
      const std::vector<std::string> words = split_delimited(comment, layout.delimiter);
      const bool by_number = file.columns.time.find_first_not_of("0123456789") == std::string::npos;
      double value = 0;
      if (!by_number && std::find(words.begin(), words.end(), file.columns.time) != words.end()) {
        layout.names = words;
      } else if (!by_number || !read_number(line.fields[std::min(layout.columns, size_t(std::stoul(file.columns.time))) - 1], value)) {
        layout.names = std::move(line.fields);  // columns named by name: the first line must hold them
        return;
      }
    }
    out.push_back(std::move(line));
  };
  for_each_data_line(path, parted_by, take, [&](const std::string& words) { comment = words; });
  return out;
}

void count_repeated(const core::EventTags& events, core::Tally& tally) {
  for (const auto& [first, again] : repeated_times(events.time))
    tally.count("events at the time of another one", events.technique + " " + events.id[first] + " and " + events.id[again]);
}

core::EventTags tags_of(const std::vector<EventMark>& marks, const EventFile& file, core::Tally& tally) {
  core::EventTags out;
  out.technique = technique_of(file);
  out.latency = file.latency.value;
  out.epoch = marks.front().second;
  for (const EventMark& m : marks) {
    out.time.push_back(m.second - out.epoch + m.fraction + file.time.offset.value);
    out.sigma.push_back(m.sigma);
    out.id.push_back(m.id);
    out.strip.push_back(0);
    out.doubtful.push_back(m.doubtful);
    out.place.push_back(m.place);
    out.place_sigma.push_back(m.place_sigma);
    if (out.size() > 1 && out.time.back() < out.time[out.size() - 2])
      tally.count("events whose time is before the one before", out.technique + " " + m.id);
  }
  if (std::none_of(out.place.begin(), out.place.end(), [](const Eigen::Vector3d& p) { return p.allFinite(); })) {
    out.place.clear();
    out.place_sigma.clear();
  }
  count_repeated(out, tally);
  tally.read("events", out.size());
  tally.keep("events", out.size());
  return out;
}

}  // namespace

std::string technique_of(const EventFile& file) { return file.technique.empty() ? file.file.stem().string() : file.technique; }

core::EventTags read_event_file(const Survey& survey, const EventFile& file, core::Tally& tally) {
  const std::filesystem::path path = resolve(survey, file.file);
  const EventFormat format = format_of(file, path);
  if (format != EventFormat::text) return tags_of(read_marks(path, file, format, tally), file, tally);
  if (file.columns.time.empty())
    throw core::usage_error("the column of the time is not stated", path.string(), "event.columns.time: a name, or a number from 1");
  DelimitedLayout layout;
  const std::vector<DataLine> rows = rows_of(path, file, layout);
  if (rows.empty()) throw core::Error("no event", path.string(), "the file is empty, or holds a header only");
  const auto column = [&](const std::string& name) -> std::optional<size_t> {
    if (name.empty()) return std::nullopt;
    return column_of(layout, name, path);
  };
  const size_t time = *column(file.columns.time);
  const std::optional<size_t> id = column(file.columns.id), strip = column(file.columns.strip);

  core::EventTags out;
  out.technique = technique_of(file);
  out.computer_clock = file.computer_clock;
  out.latency = file.latency.value;
  // The offset goes with the fraction, for the same reason as below.
  TimeTags tags = file.time;
  const double unit = tags.unit.value, offset = tags.offset.value;
  tags.offset = core::Seconds(0);
  core::TimeReader clock = reader_of(tags, path.string());
  for (const DataLine& row : rows) {
    if (layout.delimiter != ' ') row.expect_at_most(layout.columns, !layout.names.empty());
    // Whole seconds and their fraction apart: together they do not fit a double to better than 0.24 us.
    const double seconds = row.number(time) * unit, whole = std::floor(seconds);
    double gps = 0;
    try {
      gps = clock(whole / unit);
    } catch (const core::Error& e) {
      throw core::Error(e.what(), row.place, e.hint());
    }
    if (!is_instant(gps))
      throw core::Error("the time " + row.field(time) + " is not between 1980 and 2100", row.place,
                        "correct the line, or the time scale and unit that the survey states for the file");
    if (out.time.empty()) out.epoch = gps;
    out.time.push_back(gps - out.epoch + (seconds - whole) + offset);
    if (out.size() > 1 && out.time.back() < out.time[out.size() - 2]) tally.count("events whose time is before the one before", row.place);
    out.id.push_back(id ? row.field(*id) : std::to_string(out.size()));
    double line = 0;
    if (strip) {
      line = row.number(*strip);
      if (line != std::floor(line) || std::abs(line) > 1e9)
        throw core::Error("'" + row.field(*strip) + "' is no number of a strip", row.place, "strips are whole numbers");
    }
    out.strip.push_back(static_cast<std::int32_t>(line));
  }
  count_repeated(out, tally);
  tally.read("events", rows.size());
  tally.keep("events", out.size());
  out.sigma.assign(out.size(), 0.0);
  out.doubtful.assign(out.size(), 0);
  return out;
}

std::vector<core::EventTags> read_event_files(const Survey& survey, core::Tally& tally) {
  if (survey.events.empty()) throw core::usage_error("the survey names no [[event]] file", survey.name);
  std::vector<core::EventTags> out;
  for (const EventFile& file : survey.events) out.push_back(read_event_file(survey, file, tally));
  return out;
}

core::EventData events_of(const std::vector<core::EventTags>& techniques) {
  core::EventData out;
  for (const core::EventTags& t : techniques) {
    if (t.computer_clock) throw core::Error("events are still by the computer's clock", t.technique, "run time.sync with a [[clock]] log");
    for (size_t i = 0; i < t.size(); ++i) {
      out.time.push_back(t.epoch + (t.time[i] + t.latency));
      out.sigma.push_back(t.sigma[i]);
      out.id.push_back(t.id[i]);
      out.strip.push_back(t.strip[i]);
      out.technique.push_back(t.technique);
      out.doubtful.push_back(t.doubtful[i]);
      out.place.push_back(t.place.empty() ? Eigen::Vector3d::Constant(NAN) : t.place[i]);
      out.place_sigma.push_back(t.place.empty() ? Eigen::Vector3d::Zero() : t.place_sigma[i]);
    }
  }
  return out;
}

}  // namespace swath::io
