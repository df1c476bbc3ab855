// SPDX-License-Identifier: GPL-3.0-or-later
// RINEX 2.11 (Gurtner and Estey 2007), RINEX 3.05 and 4.00 (IGS/RTCM): fixed columns, header labels from column 61.
#include "io/gnss/rinex_header.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <vector>

#include "core/error.h"
#include "core/time.h"
#include "io/survey/wild_records.h"
#include "io/text/output_file.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;

constexpr double unix_of_gps_epoch = 315964800.0;
constexpr double gps_minus_beidou = 14.0;                        // s
constexpr double lowest_radius = 6.3e6, highest_radius = 6.5e6;  // m; what an aircraft or a station can be at

class Lines {
 public:
  explicit Lines(fs::path file) : file_(std::move(file)), buffer_(1 << 18) {
    in_.rdbuf()->pubsetbuf(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    if (fs::is_directory(file_)) throw core::Error("is a folder, not a file", file_.string());
    in_.open(file_, std::ios::binary);
    if (!in_) throw_system_error("cannot open", file_, errno);
  }
  bool next(std::string& line) {
    if (!std::getline(in_, line)) {
      if (in_.bad()) throw_system_error("cannot read", file_, errno);
      return false;
    }
    ++number_;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return true;
  }
  [[noreturn]] void fail(const std::string& what, const std::string& hint = {}) const {
    throw core::Error(what, file_.string() + ":" + std::to_string(number_), hint);
  }

 private:
  fs::path file_;
  std::vector<char> buffer_;
  std::ifstream in_;
  std::uint64_t number_ = 0;
};

/// The text of some columns, counted from 0, without blanks at its ends.
std::string field(const std::string& line, size_t at, size_t length) {
  if (at >= line.size()) return {};
  const std::string text = line.substr(at, length);
  const size_t first = text.find_first_not_of(" \t");
  return first == std::string::npos ? std::string{} : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// The number in some columns; `blank` where they are blank.
double number(const Lines& lines, const std::string& line, size_t at, size_t length, double blank = 0.0) {
  const std::string text = field(line, at, length);
  if (text.empty()) return blank;
  double value = 0;
  const char* begin = text.data() + (text[0] == '+' ? 1 : 0);
  const auto [end, bad] = std::from_chars(begin, text.data() + text.size(), value);
  if (bad != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) lines.fail("'" + text + "' is no number");
  return value;
}

int whole(const Lines& lines, const std::string& line, size_t at, size_t length, int blank = 0) {
  const double value = number(lines, line, at, length, blank);
  if (value != std::floor(value) || std::abs(value) > 1e6) lines.fail("'" + field(line, at, length) + "' is no whole number");
  return static_cast<int>(value);
}

enum class System { gps, glonass, galileo, beidou };

/// Times of epochs as GPS time.
class Clock {
 public:
  System system = System::gps;

  double operator()(const Lines& lines, int year, int month, int day, int hour, int minute, double second) {
    const int key = (year * 100 + month) * 100 + day;
    if (key != day_) {
      char text[16];
      std::snprintf(text, sizeof text, "%04d-%02d-%02d", std::clamp(year, 0, 9999), std::clamp(month, 0, 99), std::clamp(day, 0, 99));
      const auto midnight = core::unix_of_date(text);
      if (!midnight) lines.fail("'" + std::string(text) + "' is no date", "the epoch's line is damaged");
      midnight_ = *midnight;
      day_ = key;
    }
    if (hour < 0 || hour > 24 || minute < 0 || minute > 60 || !(second >= 0 && second <= 61)) lines.fail("is no time of day");
    const double unix = midnight_ + hour * 3600.0 + minute * 60.0 + second;
    if (system == System::glonass) return core::from_unix(unix);
    return unix - unix_of_gps_epoch + (system == System::beidou ? gps_minus_beidou : 0.0);
  }

 private:
  int day_ = -1;
  double midnight_ = 0;
};

RinexKind kind_of(const std::string& line) {
  if (line.size() > 3 && line[0] == '#' && line[1] >= 'a' && line[1] <= 'd' && (line[2] == 'P' || line[2] == 'V')) return RinexKind::orbits;
  if (field(line, 60, 20) != "RINEX VERSION / TYPE" || line.size() < 21) return RinexKind::other;
  switch (line[20]) {
    case 'O':
      return RinexKind::observations;
    case 'N':
    case 'G':
    case 'H':
    case 'L':
    case 'J':
      return RinexKind::navigation;
    case 'C':
      return RinexKind::clocks;
    default:
      return RinexKind::other;
  }
}

std::string_view name_of(RinexKind k) {
  static constexpr std::string_view names[] = {"observations", "navigation data", "satellite clocks", "satellite orbits (SP3)",
                                               "no RINEX file"};
  return names[static_cast<size_t>(k)];
}

struct FoundLabel {
  RinexHeader header;
  std::vector<RinexEvent> events;
  Clock clock;
  int observation_types = 0;  // version 2
};

/// A header record that also may come between epochs.
void take(const Lines& lines, const std::string& line, FoundLabel& f) {
  const std::string label = field(line, 60, 20);
  RinexHeader& h = f.header;
  if (label == "MARKER NAME") h.marker = field(line, 0, 60);
  if (label == "ANT # / TYPE") h.antenna_type = field(line, 20, 20);
  if (label == "APPROX POSITION XYZ") {
    const Eigen::Vector3d p(number(lines, line, 0, 14), number(lines, line, 14, 14), number(lines, line, 28, 14));
    if (p.norm() > lowest_radius && p.norm() < highest_radius) h.position = p;
  }
  if (label == "ANTENNA: DELTA H/E/N")
    h.antenna_offset = {number(lines, line, 14, 14), number(lines, line, 28, 14), number(lines, line, 0, 14)};
  if (label == "INTERVAL") {
    const double interval = number(lines, line, 0, 10);
    if (interval > 0) h.interval = interval;
  }
  if (label == "# / TYPES OF OBSERV" && !field(line, 0, 6).empty()) f.observation_types = whole(lines, line, 0, 6);
  if (label == "TIME OF FIRST OBS") {
    static const std::map<std::string, System> systems = {{"GPS", System::gps},     {"GLO", System::glonass}, {"UTC", System::glonass},
                                                          {"GAL", System::galileo}, {"QZS", System::gps},     {"IRN", System::gps},
                                                          {"BDT", System::beidou}};
    if (const std::string name = field(line, 48, 3); !name.empty()) {
      const auto at = systems.find(name);
      if (at == systems.end()) lines.fail("the time system '" + name + "' is not known");
      f.clock.system = at->second;
    }
  }
}

FoundLabel read_header(Lines& lines) {
  std::string line;
  if (!lines.next(line)) lines.fail("the file is empty");
  if (field(line, 60, 20) == "CRINEX VERS   / TYPE")
    lines.fail("the observations are compressed (Hatanaka)", "unpack the file with crx2rnx");
  if (line.size() > 1 && line[0] == '\x1f' && (line[1] == '\x8b' || line[1] == '\x9d'))
    lines.fail("the file is compressed", "unpack it with gunzip");
  const RinexKind kind = kind_of(line);
  if (kind != RinexKind::observations)
    lines.fail("holds " + std::string(name_of(kind)) + (kind == RinexKind::other ? "" : ", no observations"),
               "observations are expected here: RINEX 2, 3 or 4, type O");
  FoundLabel f;
  f.header.version = number(lines, line, 0, 9);
  if (!(f.header.version >= 2.0 && f.header.version < 5.0)) lines.fail("RINEX version " + field(line, 0, 9) + " is not read (2 to 4 are)");
  if (line.size() > 40 && line[40] != ' ') f.header.system = line[40];
  // Version 2 and 3: a file of one system counts in that system's time where it does not say otherwise.
  if (f.header.system == 'R') f.clock.system = System::glonass;
  if (f.header.system == 'C') f.clock.system = System::beidou;
  while (lines.next(line)) {
    if (field(line, 60, 20) == "END OF HEADER") return f;
    take(lines, line, f);
  }
  lines.fail("the header has no end", "the file is cut off");
}

double second_of(const Lines& lines, const std::string& line, const FoundLabel& f) {
  return f.header.version >= 3.0 ? number(lines, line, 18, 11) : number(lines, line, 15, 11);
}

/// The time of an epoch's line with these seconds of the minute.
double epoch_time(const Lines& lines, const std::string& line, FoundLabel& f, double second) {
  const bool new_form = f.header.version >= 3.0;
  int year = new_form ? whole(lines, line, 2, 4) : whole(lines, line, 1, 2);
  if (!new_form) year += year < 80 ? 2000 : 1900;
  const size_t month = new_form ? 7 : 4;
  return f.clock(lines, year, whole(lines, line, month, 2), whole(lines, line, month + 3, 2), whole(lines, line, month + 6, 2),
                 whole(lines, line, month + 9, 2), second);
}

/// Steps to the next epoch of measurements and reads its time; false at the end of the file.
bool next_epoch(Lines& lines, std::string& line, FoundLabel& f, double& time) {
  const bool new_form = f.header.version >= 3.0;
  while (lines.next(line)) {
    if (new_form ? line.empty() || line[0] != '>' : field(line, 0, line.size()).empty()) continue;
    const int flag = new_form ? whole(lines, line, 31, 1) : whole(lines, line, 28, 1);
    const int count = new_form ? whole(lines, line, 32, 3) : whole(lines, line, 29, 3);
    const bool measured = flag <= 1 || flag == 6;
    if (flag <= 1) {
      time = epoch_time(lines, line, f, second_of(lines, line, f));
      if (!is_instant(time)) lines.fail("the epoch is not between 1980 and 2100");
    }
    if (flag == 5) {
      const double second = second_of(lines, line, f), whole_second = std::floor(second);
      f.events.push_back({epoch_time(lines, line, f, whole_second), second - whole_second});
      if (!is_instant(f.events.back().second)) lines.fail("the event is not between 1980 and 2100");
    }
    int pass = new_form && measured ? 0 : count;  // version 3 marks its epochs: what lies between them need not be counted
    if (!new_form && measured) {
      if (f.observation_types <= 0) lines.fail("the header names no types of observations");
      pass = (count + 11) / 12 - 1 + count * ((f.observation_types + 4) / 5);
    }
    std::string record;
    for (int i = 0; i < pass && lines.next(record); ++i)
      if (!measured) take(lines, record, f);
    if (flag <= 1) return true;
  }
  return false;
}

}  // namespace

RinexKind rinex_kind(const fs::path& file) {
  Lines lines(file);
  std::string line;
  return lines.next(line) ? kind_of(line) : RinexKind::other;
}

RinexObservations scan_rinex(const fs::path& file) {
  Lines lines(file);
  FoundLabel found = read_header(lines);
  RinexObservations out;
  std::map<std::int64_t, std::uint64_t> steps;  // 0.1 ms -> count
  std::string line;
  for (double time = 0; next_epoch(lines, line, found, time);) {
    if (out.epochs > 0 && time > out.last) {
      ++steps[std::llround((time - out.last) * 1e4)];
      out.longest_gap = std::max(out.longest_gap, time - out.last);
    }
    if (out.epochs == 0) out.first = out.last = time;
    out.first = std::min(out.first, time);
    out.last = std::max(out.last, time);
    ++out.epochs;
  }
  if (out.epochs == 0) throw core::Error("no epoch of observations", file.string(), "the file ends after its header");
  std::uint64_t n = 0, seen = 0;
  for (const auto& [step, count] : steps) n += count;
  for (const auto& [step, count] : steps) {
    seen += count;
    if (2 * seen >= n) {
      out.interval = static_cast<double>(step) * 1e-4;
      break;
    }
  }
  out.header = found.header;
  out.events = found.events.size();
  return out;
}

std::vector<RinexEvent> rinex_events(const fs::path& file) {
  Lines lines(file);
  FoundLabel found = read_header(lines);
  std::string line;
  for (double time = 0; next_epoch(lines, line, found, time);) continue;
  return std::move(found.events);
}

}  // namespace swath::io
