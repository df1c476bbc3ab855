// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the columns: "Monitoring Options" of ntpd's documentation (loopstats, peerstats); the status word: its "Event Messages and
// Status Words" (five bits of status, three of selection, four of count, four of code). Logs are small: ntpd writes 5400 lines a day at
// most, a PPS log 86 400.
#include "io/records/clock_log.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/time.h"
#include "io/text/data_lines.h"
#include "io/text/delimited.h"
#include "io/text/line_reader.h"

namespace swath::io {
namespace {

constexpr double day_seconds = 86400.0;
constexpr double mjd_of_1970 = 40587.0, mjd_of_gps = 44244.0;
constexpr double latest_mjd = 124593.0;  // 2200-01-01
constexpr const char* clock_records = "clock records";
constexpr int system_peer = 6, pps_peer = 7;

struct Columns {
  size_t day = 0, second = 1, offset = 2;
  std::optional<size_t> jitter;
};

struct Record {
  double day = 0.0, second = 0.0;  // POSIX day since 1970, second of it
  double offset = 0.0, jitter = 0.0;
  std::uint64_t line = 0;
};

/// Day and second from MJD and second of day; a log may count on past midnight.
void read_instant(const DataLine& line, const Columns& c, Record& r) {
  const double mjd = line.number(c.day);
  r.second = line.number(c.second);
  if (mjd < mjd_of_gps || mjd > latest_mjd || mjd != std::floor(mjd))
    line.fault("'" + line.field(c.day) + "' is no Modified Julian Day", "the first column is the MJD, 54921 for 2009-03-31");
  if (r.second < 0 || r.second >= 2 * day_seconds)
    line.fault("'" + line.field(c.second) + "' is no second of a day", "the second column is the UTC second of the day");
  r.day = mjd - mjd_of_1970;
}

std::string name_of(ClockFormat f) { return std::string(core::Choices<ClockFormat>::names[static_cast<size_t>(f)]); }

/// Is it the address of a source, of either version of IP?
bool is_address(const std::string& text) { return std::count(text.begin(), text.end(), '.') > 1 || text.find(':') != std::string::npos; }

/// What a line is by its form; nothing where it is of no known one.
std::optional<ClockFormat> form_of(const DataLine& line) {
  const size_t n = line.fields.size();
  if (n >= 5 && is_address(line.fields[2])) return ClockFormat::peerstats;
  const bool numbers = std::all_of(line.fields.begin(), line.fields.end(), [](const std::string& f) {
    double value = 0;
    return read_number(f.substr(0, f.find('#')), value);
  });
  if (!numbers || n > 7 || n == 3 || n == 4) return std::nullopt;
  return n <= 2 ? ClockFormat::pps : ClockFormat::loopstats;
}

/// One log read as another gives offsets that look right: a line of another form is a fault.
void expect_form(const DataLine& line, ClockFormat stated) {
  const std::optional<ClockFormat> form = form_of(line);
  if (form && *form != stated)
    line.fault("the format is stated as " + name_of(stated) + ", and the line has the form of " + name_of(*form),
               "state format = \"" + name_of(*form) + "\" for this [[clock]]");
}

/// The columns that a line of names gives.
Columns named(const DataLine& line) {
  const auto find = [&](std::initializer_list<std::string_view> beginnings) -> std::optional<size_t> {
    for (const std::string_view b : beginnings)
      for (size_t i = 0; i < line.fields.size(); ++i) {
        std::string name = line.fields[i];
        for (char& ch : name) ch = ch >= 'A' && ch <= 'Z' ? static_cast<char>(ch - 'A' + 'a') : ch;
        if (!name.starts_with(b)) continue;
        for (const char* other : {"_ms", "_us", "_ns", "(ms)", "(us)", "(ns)"})
          if (name.ends_with(other)) line.fault("column '" + name + "' is not in seconds", "export the log in seconds");
        return i;
      }
    return std::nullopt;
  };
  const auto need = [&](const char* what, std::initializer_list<std::string_view> beginnings) {
    if (const auto at = find(beginnings)) return *at;
    line.fault(std::string("no column of names begins with ") + what, "names of columns: mjd, sec, offset, jitter");
  };
  return {need("mjd", {"mjd"}), need("sec or utc_sec", {"sec", "utc_sec", "utc sec"}), need("offset", {"offset"}), find({"jitter"})};
}

/// Calls f for every line of data; a first line of names goes to `names`. Any run of tabs and blanks parts the columns.
void for_each_line(const std::filesystem::path& file, const std::function<void(DataLine&)>& names,
                   const std::function<void(DataLine&)>& f) {
  bool first = true;
  const auto parted_by = [](const std::string& line) {
    const char found = delimiter_in(line);
    return found == '\t' ? ' ' : found;
  };
  for_each_data_line(file, parted_by, [&](DataLine& line) {
    double value = 0;
    const bool data = !std::exchange(first, false) || read_number(line.fields[0].substr(0, line.fields[0].find('#')), value);
    data ? f(line) : names(line);
  });
}

std::vector<Record> read_loopstats(const std::filesystem::path& file) {
  std::vector<Record> out;
  std::optional<Columns> columns;
  for_each_line(
      file, [&](DataLine& line) { columns = named(line); },
      [&](DataLine& line) {
        if (!columns) {
          expect_form(line, ClockFormat::loopstats);
          columns.emplace();
          if (line.fields.size() >= 6) columns->jitter = 4;
        }
        Record r;
        read_instant(line, *columns, r);
        r.offset = line.number(columns->offset);
        if (columns->jitter) r.jitter = line.number(*columns->jitter);
        r.line = line.line;
        out.push_back(r);
      });
  return out;
}

std::vector<Record> read_peerstats(const std::filesystem::path& file, core::Tally& tally) {
  std::map<int, std::vector<Record>> by_selection;
  std::map<std::string, size_t> sources;
  const Columns columns{0, 1, 4, {}};
  const auto read = [&](DataLine& line) {
    if (sources.empty()) expect_form(line, ClockFormat::peerstats);
    Record r;
    read_instant(line, columns, r);
    r.offset = line.number(columns.offset);
    r.line = line.line;
    if (line.fields.size() >= 7) r.jitter = line.number(std::min<size_t>(7, line.fields.size() - 1));
    const std::string& status = line.field(3);
    unsigned word = 0;
    const auto [end, bad] = std::from_chars(status.data(), status.data() + status.size(), word, 16);
    if (bad != std::errc{} || end != status.data() + status.size())
      line.fault("'" + status + "' is no status word", "the fourth column of peerstats is the peer's status in hexadecimal");
    ++sources[line.field(2)];
    by_selection[static_cast<int>(word >> 8 & 7)].push_back(r);
  };
  for_each_line(
      file, [](DataLine&) {}, read);
  std::vector<Record> out;
  size_t all = 0;
  for (const auto& [selection, records] : by_selection) all += records.size();
  for (const int selection : {pps_peer, system_peer})
    if (out.empty() && by_selection.contains(selection)) out = by_selection[selection];
  if (out.empty() && sources.size() == 1) {
    for (const auto& [selection, records] : by_selection) out.insert(out.end(), records.begin(), records.end());
    std::sort(out.begin(), out.end(), [](const Record& a, const Record& b) { return a.line < b.line; });
  }
  if (out.empty() && all > 0)
    throw core::Error(sources.size() == 1 ? "its only source is never selected"
                                          : "none of its " + std::to_string(sources.size()) + " sources is ever selected",
                      file.string(), "the clock was not steered: use loopstats, or a file of one source alone");
  tally.read(clock_records, all - out.size());
  if (out.size() < all) tally.count("clock records of sources that did not steer the clock, left out", all - out.size());
  return out;
}

std::vector<Record> read_pulses(const std::filesystem::path& file) {
  std::vector<Record> out;
  const Columns columns;
  for_each_line(
      file, [](DataLine&) {},
      [&](DataLine& line) {
        const auto remark =
            std::find_if(line.fields.begin() + 1, line.fields.end(), [](const std::string& f) { return f.empty() || f.starts_with('#'); });
        line.fields.erase(remark, line.fields.end());
        line.fields[0] = line.fields[0].substr(0, line.fields[0].find('#'));
        expect_form(line, ClockFormat::pps);
        if (line.fields.size() > 2)
          line.fault("has " + std::to_string(line.fields.size()) + " columns, and a log of pulses has one or two",
                     "one column: POSIX seconds; two columns: MJD and seconds of the day");
        Record r;
        if (line.fields.size() >= 2) {
          read_instant(line, columns, r);
        } else {
          // Whole seconds and their fraction apart: together they do not fit a double to better than 0.24 us.
          const size_t dot = std::min(line.fields[0].find('.'), line.fields[0].size());
          const DataLine parts{line.place, line.line, {line.fields[0].substr(0, dot), "0" + line.fields[0].substr(dot)}};
          const double whole = parts.number(0);
          if (whole < (mjd_of_gps - mjd_of_1970) * day_seconds || whole > (latest_mjd - mjd_of_1970) * day_seconds ||
              whole != std::floor(whole))
            line.fault("'" + line.fields[0] + "' is no POSIX time between 1980 and 2200",
                       "one column: POSIX seconds; two columns: MJD and seconds of the day");
          r.day = std::floor(whole / day_seconds);
          r.second = whole - r.day * day_seconds + parts.number(1);
        }
        r.offset = std::round(r.second) - r.second;
        r.line = line.line;
        out.push_back(r);
      });
  return out;
}

}  // namespace

core::ClockData read_clock_log(const std::filesystem::path& file, ClockFormat format, core::Tally& tally) {
  std::vector<Record> records;
  switch (format) {
    case ClockFormat::loopstats:
      records = read_loopstats(file);
      break;
    case ClockFormat::peerstats:
      records = read_peerstats(file, tally);
      break;
    case ClockFormat::pps:
      records = read_pulses(file);
      break;
  }
  if (records.empty()) throw core::Error("the log has no record", file.string(), "was the statistics switched on?");
  const auto where = [&](const Record& r) { return file.string() + ":" + std::to_string(r.line); };
  core::ClockData out;
  out.epoch = core::from_unix(records.front().day * day_seconds);
  out.steered = format != ClockFormat::pps;
  const bool with_jitter = std::any_of(records.begin(), records.end(), [](const Record& r) { return r.jitter > 0; });
  for (const Record& r : records) {
    const double t = core::from_unix(r.day * day_seconds) - out.epoch + r.second;
    if (!out.time.empty() && t < out.time.back()) {
      tally.count("clock records before the clock was set back, left out", where(r), out.size());
      for (auto* c : {&out.time, &out.offset, &out.jitter}) c->clear();
    } else if (!out.time.empty() && t == out.time.back()) {
      tally.count("clock records at a repeated time, left out", where(r));
      continue;
    }
    out.time.push_back(t);
    out.offset.push_back(r.offset);
    if (with_jitter) out.jitter.push_back(r.jitter);
  }
  tally.read(clock_records, records.size());
  tally.keep(clock_records, out.size());
  return out;
}

core::ClockData read_clock_logs(const Survey& survey, core::Tally& tally) {
  if (survey.clock.empty()) throw core::usage_error("the survey names no [[clock]]", survey.name);
  std::vector<std::pair<core::ClockData, std::string>> parts;
  for (const ClockLog& log : survey.clock) {
    if (log.format != survey.clock.front().format)
      throw core::usage_error("is of another format than " + survey.clock.front().file.string(), log.file.string(),
                              "state the logs of one format only: two views of one clock have no order");
    parts.emplace_back(read_clock_log(resolve(survey, log.file), log.format, tally), log.file.string());
  }
  std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) {
    return a.first.epoch + a.first.time.front() < b.first.epoch + b.first.time.front();
  });
  core::ClockData out = std::move(parts.front().first);
  for (size_t k = 1; k < parts.size(); ++k) {
    const core::ClockData& next = parts[k].first;
    const double shift = next.epoch - out.epoch;
    if (next.time.front() + shift <= out.time.back())
      throw core::Error(parts[k - 1].second + " and " + parts[k].second + " overlap in time", parts[k].second,
                        "state each stretch of the log once");
    // A part without jitter would leave the column shorter: then no part's is used.
    if (out.jitter.empty() || next.jitter.empty())
      out.jitter.clear();
    else
      out.jitter.insert(out.jitter.end(), next.jitter.begin(), next.jitter.end());
    for (const double t : next.time) out.time.push_back(t + shift);
    out.offset.insert(out.offset.end(), next.offset.begin(), next.offset.end());
  }
  return out;
}

}  // namespace swath::io
