// SPDX-License-Identifier: GPL-3.0-or-later
// Source: NMEA 0183, as receivers' interface descriptions give it (sentences GGA, GST, RMC, ZDA).
#include "io/gnss/nmea.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "core/geo/geodesy.h"
#include "core/time.h"
#include "io/gnss/fix_list.h"
#include "io/text/line_reader.h"

namespace swath::io {
namespace {

using core::FixQuality;
using Fields = std::vector<std::string_view>;

constexpr double day = 86400.0;
constexpr double rolled_over = 1024 * core::seconds_per_week;
constexpr size_t longest_sentence = 1024;  // the standard has 82; receivers exceed it
constexpr size_t look_at = 1 << 16;

/// A sentence between $ and *, checked.
struct Sentence {
  std::string kind;  ///< "GGA", or all of a proprietary address
  Fields fields;     ///< [0] is the address
};

enum class Found { nothing, wrong, right };

int hex(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

Fields split(std::string_view text) {
  Fields out;
  for (;;) {
    const size_t comma = text.find(',');
    out.push_back(text.substr(0, comma));
    if (comma == std::string_view::npos) return out;
    text.remove_prefix(comma + 1);
  }
}

/// Reads the sentence that starts behind a $. `wrong`: it looks like one and its checksum is wrong or missing.
Found read_sentence(std::string_view text, Sentence& out) {
  size_t letters = 0;
  while (letters < text.size() && ((text[letters] >= 'A' && text[letters] <= 'Z') || (text[letters] >= '0' && text[letters] <= '9')))
    ++letters;
  if (letters < 3 || letters == text.size() || text[letters] != ',') return Found::nothing;
  const size_t star = text.find_first_of("*$");
  if (star == std::string_view::npos || text[star] != '*' || star + 2 >= text.size() || star > longest_sentence) return Found::wrong;
  unsigned sum = 0;
  for (const char c : text.substr(0, star)) sum ^= static_cast<unsigned char>(c);
  const int high = hex(text[star + 1]), low = hex(text[star + 2]);
  if (high < 0 || low < 0 || sum != static_cast<unsigned>(high * 16 + low)) return Found::wrong;
  out.fields = split(text.substr(0, star));
  out.kind = out.fields[0][0] == 'P' || letters != 5 ? out.fields[0] : out.fields[0].substr(2);
  return Found::right;
}

/// "hhmmss.ss" as seconds of the day (an inserted second is 86400.x); NaN where it is none.
double of_day(std::string_view text) {
  double hour = 0, minute = 0, second = 0;
  if (text.size() < 6 || !read_number(text.substr(0, 2), hour) || !read_number(text.substr(2, 2), minute) ||
      !read_number(text.substr(4), second) || hour > 23 || minute > 59 || second >= 61)
    return Fix::none;
  return hour * 3600 + minute * 60 + second;
}

/// "ddmm.mmm" and its hemisphere in degrees; NaN where they are none.
double degrees_of(std::string_view text, std::string_view hemisphere, char positive, char negative) {
  double value = 0;
  if (!read_number(text, value) || hemisphere.size() != 1 || (hemisphere[0] != positive && hemisphere[0] != negative)) return Fix::none;
  const double whole = std::floor(value / 100), minutes = value - 100 * whole;
  if (minutes >= 60) return Fix::none;
  return (hemisphere[0] == negative ? -1 : 1) * (whole + minutes / 60);
}

double number(std::string_view text) {
  double v = 0;
  return read_number(text, v) ? v : Fix::none;
}

/// POSIX seconds of a date's midnight; NaN where it is none.
double midnight_of(int year, std::string_view month, std::string_view of_month) {
  std::array<char, 16> text{};
  const double m = number(month), d = number(of_month);
  if (!(m >= 1 && m <= 12 && d >= 1 && d <= 31)) return Fix::none;
  std::snprintf(text.data(), text.size(), "%04d-%02d-%02d", year % 10000, static_cast<int>(m), static_cast<int>(d));
  return core::unix_of_date(text.data()).value_or(Fix::none);
}

/// The date of an RMC or ZDA; NaN where it states none.
NmeaDate date_of(const Sentence& s) {
  NmeaDate out{Fix::none, Fix::none};
  if (s.kind == "RMC" && s.fields.size() > 9 && s.fields[2] == "A" && s.fields[9].size() == 6) {
    const std::string_view d = s.fields[9];
    const double year = number(d.substr(4));
    if (year >= 0)
      out = {midnight_of(static_cast<int>(year) + (year < 80 ? 2000 : 1900), d.substr(2, 2), d.substr(0, 2)), of_day(s.fields[1])};
  }
  if (s.kind == "ZDA" && s.fields.size() > 4) {
    const double year = number(s.fields[4]);
    if (year >= 1980 && year <= 9999) out = {midnight_of(static_cast<int>(year), s.fields[3], s.fields[2]), of_day(s.fields[1])};
  }
  return out;
}

class Scanner {
 public:
  Scanner(NmeaFile& out, core::Tally& tally) : out_(out), tally_(tally) {}

  void take(const Sentence& s, const LineReader& at, std::uint64_t line) {
    ++out_.sentences[s.kind];
    if (s.kind == "GGA") {
      tally_.read("NMEA positions", 1);
      position(s, at, line);
    }
    if (s.kind == "GST") sigmas(s);
    if (s.kind != "RMC" && s.kind != "ZDA") return;
    const NmeaDate date = date_of(s);
    if (!std::isfinite(date.midnight + date.of_day)) return;
    // A position's own sentence may stand behind it.
    for (auto f = out_.fixes.rbegin(); f != out_.fixes.rend() && f->line + 50 > line; ++f)
      if (f->of_day == date.of_day) f->date = out_.dates.size();
    out_.dates.push_back(date);
  }

 private:
  void position(const Sentence& s, const LineReader& at, std::uint64_t line) {
    const Fields& f = s.fields;
    NmeaFix fix;
    if (f.size() < 12) return tally_.count("NMEA positions that are cut off, left out", at.place());
    fix.quality = f[6].size() == 1 ? f[6][0] - '0' : 0;
    if (fix.quality < 1) return tally_.count("NMEA positions without a solution, left out", at.place());
    if (fix.quality > 5 && fix.quality != 9)
      return tally_.count("NMEA positions estimated, entered by hand or simulated, left out", at.place());
    const double separation = number(f[11]);
    if (std::isnan(separation)) return tally_.count("NMEA positions without a geoid separation, left out", at.place());
    fix.of_day = of_day(f[1]);
    if (!out_.fixes.empty() && out_.fixes.back().of_day == fix.of_day && f[0] != address_)
      return tally_.count("NMEA positions that another talker has stated for the same time, left out", at.place());
    address_ = f[0];
    fix.latitude = degrees_of(f[2], f[3], 'N', 'S');
    fix.longitude = degrees_of(f[4], f[5], 'E', 'W');
    fix.height = number(f[9]) + separation;
    fix.satellites = std::isnan(number(f[7])) ? 0 : number(f[7]);
    fix.sigma_north = fix.sigma_east = fix.sigma_up = Fix::none;
    fix.line = line;
    fix.date = out_.dates.empty() ? none : out_.dates.size() - 1;
    if (fix.of_day == sigma_time_) set_sigmas(fix);
    out_.fixes.push_back(fix);
  }

  void sigmas(const Sentence& s) {
    if (s.fields.size() < 9) return;
    sigma_time_ = of_day(s.fields[1]);
    for (size_t i = 0; i < 3; ++i) sigma_[i] = number(s.fields[6 + i]);
    if (!out_.fixes.empty() && out_.fixes.back().of_day == sigma_time_) set_sigmas(out_.fixes.back());
  }

  void set_sigmas(NmeaFix& fix) const {
    fix.sigma_north = sigma_[0];
    fix.sigma_east = sigma_[1];
    fix.sigma_up = sigma_[2];
  }

  static constexpr size_t none = ~size_t{0};
  NmeaFile& out_;
  core::Tally& tally_;
  std::string address_;  ///< of the last position, "GNGGA"
  double sigma_time_ = Fix::none;
  std::array<double, 3> sigma_{};
};

/// GPS time of positions by the dates of the file, which may be wrong by whole roll-overs of the week.
class Days {
 public:
  Days(const NmeaFile& file, const GnssFile& stated, const std::string& name, core::Tally& tally) : dates_(file.dates) {
    const double first = file.fixes.empty() ? 0 : file.fixes.front().of_day;
    if (dates_.empty()) {
      if (stated.time.date.empty())
        throw core::usage_error("no RMC or ZDA sentence states the date", name,
                                "state time = {date = \"YYYY-MM-DD\"} of the first position");
      clock_.emplace(core::TimeScale::utc_day, std::nullopt, stated.time.date, name);
      return;
    }
    if (stated.time.date.empty() || file.fixes.empty()) return;
    const std::optional<double> day_stated = core::unix_of_date(stated.time.date);
    if (!day_stated) throw core::usage_error("\"" + stated.time.date + "\" is no date", name, "write it as YYYY-MM-DD");
    const double found = midnight(file.fixes.front());
    const double times = std::round((*day_stated - found) / rolled_over);
    if (*day_stated - found != times * rolled_over)
      throw core::Error("the first position is of " + core::utc_text(core::from_unix(found + first)) + ", not of " + stated.time.date, name,
                        "correct time.date, or leave it out");
    shift_ = times * rolled_over;
    if (shift_ != 0)
      tally.count(
          "NMEA files whose GPS week had rolled over: moved to the stated date",
          name + ": from " + core::utc_text(core::from_unix(found + first)) + " by " + core::format_number(times * 1024) + " weeks");
  }

  double operator()(const NmeaFix& fix) {
    if (clock_) return (*clock_)(fix.of_day);
    return core::from_unix(midnight(fix) + shift_) + fix.of_day;
  }

 private:
  double midnight(const NmeaFix& fix) const {
    const NmeaDate& d = dates_[fix.date < dates_.size() ? fix.date : 0];
    const double passed = fix.of_day - d.of_day;
    return d.midnight + (passed < -0.5 * day ? day : passed > 0.5 * day ? -day : 0);
  }

  const std::vector<NmeaDate>& dates_;
  std::optional<core::TimeReader> clock_;
  double shift_ = 0;  // s
};

FixQuality quality_of(int number) {
  switch (number) {
    case 1:
    case 3:
      return FixQuality::single;
    case 2:
      return FixQuality::differential;
    case 4:
      return FixQuality::fixed;
    case 5:
      return FixQuality::float_ambiguity;
    case 9:  // NovAtel
      return FixQuality::sbas;
    default:
      return FixQuality::unknown;
  }
}

}  // namespace

bool looks_like_nmea(const std::filesystem::path& path) {
  const BinaryFile file(path);
  std::string start(look_at, '\0');
  start.resize(file.read_some(0, start.data(), start.size()));
  Sentence s;
  const std::string_view text = start;
  for (size_t at = text.find('$'); at != std::string_view::npos; at = text.find('$', at + 1))
    if (read_sentence(text.substr(at + 1, longest_sentence), s) == Found::right) return true;
  return false;
}

NmeaFile scan_nmea(const std::filesystem::path& path, core::Tally& tally) {
  NmeaFile out;
  std::uint64_t all_lines = 0, good_lines = 0, sentences = 0, good_sentences = 0;
  Scanner scanner(out, tally);
  LineReader lines(path);
  std::string_view line;
  Sentence s;
  for (std::uint64_t number = 1; lines.next(line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    ++all_lines;
    bool any = false;
    for (size_t at = line.find('$'); at != std::string_view::npos; at = line.find('$', at + 1)) {
      const Found found = read_sentence(line.substr(at + 1), s);
      if (found == Found::nothing) continue;
      any = true;
      ++sentences;
      good_sentences += found == Found::right;
      if (found == Found::right)
        scanner.take(s, lines, number);
      else
        tally.count("NMEA sentences whose checksum is wrong or missing, left out", lines.place());
    }
    good_lines += any;
    if (!any) tally.count("NMEA lines without a sentence, left out", lines.place());
  }
  tally.read("NMEA lines", all_lines);
  tally.keep("NMEA lines", good_lines);
  tally.read("NMEA sentences", sentences);
  tally.keep("NMEA sentences", good_sentences);
  tally.keep("NMEA positions", out.fixes.size());
  return out;
}

core::GnssData read_nmea(const std::filesystem::path& path, const GnssFile& f, double latency, core::Tally& tally) {
  const std::string name = path.string();
  const NmeaFile file = scan_nmea(path, tally);
  if (file.fixes.empty())
    throw core::Error("no GGA sentence states a position", name,
                      file.sentences.empty() ? "is it a NMEA log?" : "the receiver had no solution, or writes no GGA");
  Days days(file, f, name, tally);
  FixList fixes(f, name, latency + f.time.offset.value, true, tally);
  for (const NmeaFix& n : file.fixes) {
    Fix fix;
    const double latitude = n.latitude * core::degree, longitude = n.longitude * core::degree;
    if (std::isfinite(n.of_day)) fix.time = days(n);
    fix.position = core::ecef_of({latitude, longitude, n.height});
    const Eigen::Vector3d sigma(n.sigma_north, n.sigma_east, n.sigma_up);
    if (sigma.allFinite()) fix.covariance = ecef_covariance(sigma.cwiseAbs2().asDiagonal(), latitude, longitude);
    fix.quality = quality_of(n.quality);
    fix.satellites = n.satellites;
    fixes.add(fix, n.line);
  }
  return fixes.finish();
}

}  // namespace swath::io
