// SPDX-License-Identifier: GPL-3.0-or-later
// NovAtel: OEM7 Commands and Logs Reference, MARK1TIME and "32-bit CRC"; GPS time = seconds - offset. DJI: user manuals (Matrice 4 Series,
// "Image log file"); the labels behind the numbers say what each is, the manual's order of latitude and longitude is not that of the files.
#include "io/records/event_marks.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/geodesy.h"
#include "core/time.h"
#include "io/gnss/rinex_header.h"
#include "io/survey/wild_records.h"
#include "io/text/binary_file.h"
#include "io/text/line_reader.h"

namespace swath::io {
namespace {

std::uint32_t novatel_crc(std::string_view text) {
  std::uint32_t crc = 0;
  for (const char c : text) {
    crc ^= static_cast<std::uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
  }
  return crc;
}

/// 1 to 4 for a line of MARKTIME (1) or MARK1TIME to MARK4TIME; 0 for others.
int input_of(std::string_view line) {
  if (line.starts_with("#MARKTIMEA,")) return 1;
  if (line.size() > 11 && line.starts_with("#MARK") && line.substr(6, 6) == "TIMEA," && line[5] >= '1' && line[5] <= '4')
    return line[5] - '0';
  return 0;
}

/// Seconds as written, whole and fraction; false where they are no number.
bool split_seconds(std::string_view text, double& whole, double& fraction) {
  double value = 0;
  if (!read_number(text, value) || !std::isfinite(value) || value < 0 || value > 1e9) return false;
  const size_t point = text.find('.');
  whole = std::floor(value);
  fraction = 0;
  return point == std::string_view::npos || read_number("0" + std::string(text.substr(point)), fraction);
}

std::vector<std::string_view> parts_of(std::string_view text, char by) {
  std::vector<std::string_view> out;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(by, begin), text.size());
    out.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

/// The mark of a NovAtel line; false where it is damaged.
bool novatel_mark(std::string_view line, EventMark& out) {
  const size_t star = line.rfind('*'), header = line.find(';');
  if (star == std::string_view::npos || header == std::string_view::npos || header > star) return false;
  std::uint32_t stated = 0;
  const std::string_view hex = line.substr(star + 1, 8);
  if (hex.size() != 8 || std::from_chars(hex.data(), hex.data() + 8, stated, 16).ptr != hex.data() + 8) return false;
  if (stated != novatel_crc(line.substr(1, star - 1))) return false;
  const auto fields = parts_of(line.substr(header + 1, star - header - 1), ',');
  double week = 0, seconds = 0, fraction = 0, offset = 0, sigma = 0;
  if (fields.size() < 6 || !read_number(fields[0], week) || !split_seconds(fields[1], seconds, fraction) ||
      !read_number(fields[2], offset) || !read_number(fields[3], sigma))
    return false;
  if (!(week >= 0 && week < 10000 && std::abs(offset) < 1.0 && sigma >= 0)) return false;
  out.second = core::from_week(static_cast<int>(week), seconds);
  out.fraction = fraction - offset;
  out.sigma = sigma;
  out.doubtful = fields[5] != "VALID";
  return is_instant(out.second);
}

/// One line of an MRK: fields part by tabs, a number's label stands behind a comma.
class MrkLine {
 public:
  MrkLine(std::string_view line, std::string place) : place_(std::move(place)) {
    for (const std::string_view field : parts_of(line, '\t')) {
      std::vector<std::string_view> parts;
      for (std::string_view p : parts_of(field, ',')) {
        while (!p.empty() && p.front() == ' ') p.remove_prefix(1);
        while (!p.empty() && (p.back() == ' ' || p.back() == '\r')) p.remove_suffix(1);
        parts.push_back(p);
      }
      fields_.push_back(parts);
    }
    if (fields_.size() < 10) fail();
  }
  double labelled(std::string_view label) const {
    for (const auto& f : fields_)
      if (f.size() == 2 && f[1] == label) return number(f[0]);
    fail();
  }
  double plain(size_t field) const { return number(fields_[field][0]); }
  std::string_view text(size_t field) const { return fields_[field][0]; }
  /// The field of three numbers: the sigmas.
  Eigen::Vector3d three() const {
    for (const auto& f : fields_)
      if (f.size() == 3) return {number(f[0]), number(f[1]), number(f[2])};
    fail();
  }
  [[noreturn]] void fail() const {
    throw core::Error("is no line of a Timestamp.MRK", place_,
                      "expected: photo, seconds of week, [week], N, E, V, Lat, Lon, Ellh, three sigmas, Q, parted by tabs");
  }

 private:
  double number(std::string_view text) const {
    double value = 0;
    if (!read_number(text, value) || !std::isfinite(value)) fail();
    return value;
  }
  std::string place_;
  std::vector<std::vector<std::string_view>> fields_;
};

EventMark mrk_mark(const MrkLine& line) {
  EventMark e;
  e.id = std::string(line.text(0));
  const std::string_view week = line.text(2);
  double week_number = 0, seconds = 0;
  if (week.size() < 3 || week.front() != '[' || week.back() != ']' || !read_number(week.substr(1, week.size() - 2), week_number) ||
      !(week_number >= 0 && week_number < 10000) || !split_seconds(line.text(1), seconds, e.fraction))
    line.fail();
  e.second = core::from_week(static_cast<int>(week_number), seconds);
  e.doubtful = line.labelled("Q") == 0;
  const Eigen::Vector3d to_camera = 1e-3 * Eigen::Vector3d(line.labelled("N"), line.labelled("E"), line.labelled("V"));
  const double latitude = line.labelled("Lat"), longitude = line.labelled("Lon");
  if (!(std::abs(latitude) <= 90 && std::abs(longitude) <= 360)) line.fail();
  const core::Geodetic camera{latitude * core::degree, longitude * core::degree, line.labelled("Ellh")};
  if (!e.doubtful) e.place = core::ecef_of(camera) - core::ecef_R_ned(camera.latitude, camera.longitude) * to_camera;
  e.place_sigma = line.three();
  return e;
}

std::string ending_of(const std::filesystem::path& file) {
  std::string out = file.extension().string();
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

}  // namespace

EventFormat event_format(const std::filesystem::path& path) {
  const std::string ending = ending_of(path);
  if (ending == ".ubx") return EventFormat::ubx;
  if (ending == ".mrk") return EventFormat::mrk;
  const BinaryFile file(path);
  std::string start(std::size_t{1} << 20, '\0');  // settings and other logs may come first
  start.resize(file.read_some(0, start.data(), start.size()));
  if (start.starts_with("\xb5\x62")) return EventFormat::ubx;
  if (std::string_view(start).substr(0, 4096).find('\0') == std::string::npos) {
    for (size_t at = start.find("#MARK"); at != std::string::npos; at = start.find("#MARK", at + 1))
      if (input_of(std::string_view(start).substr(at)) > 0) return EventFormat::novatel;
    if (rinex_kind(path) == RinexKind::observations) return EventFormat::rinex;
  }
  return EventFormat::text;
}

std::vector<EventMark> read_novatel_marks(const std::filesystem::path& file, int input, core::Tally& tally) {
  LineReader lines(file);
  std::vector<EventMark> out;
  std::uint64_t damaged = 0;
  for (std::string_view line; lines.next(line);) {
    const int at = input_of(line);
    if (at == 0 || (input > 0 && at != input)) continue;
    EventMark e;
    if (!novatel_mark(line, e)) {
      tally.count("damaged lines of MARKTIME, left out", lines.place());
      ++damaged;
      continue;
    }
    e.id = std::to_string(out.size() + 1);
    out.push_back(e);
  }
  if (out.empty())
    throw core::Error(damaged > 0 ? "every line of MARKTIME is damaged" : "holds no line of MARKTIME", file.string(),
                      "let the receiver log MARK1TIMEA ONNEW (or MARK2TIMEA ...); event.input chooses among inputs");
  return out;
}

std::vector<EventMark> read_mrk(const std::filesystem::path& file, core::Tally& tally) {
  LineReader lines(file);
  std::vector<EventMark> out;
  for (std::string_view line; lines.next(line);) {
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    const EventMark e = mrk_mark(MrkLine(line, lines.place()));
    if (!is_instant(e.second)) throw core::Error("the time is not between 1980 and 2100", lines.place(), "the camera had no GPS time");
    if (e.doubtful) tally.count("photos without a position of the drone's own", lines.place());
    out.push_back(e);
  }
  if (out.empty()) throw core::Error("no event", file.string(), "the file is empty");
  return out;
}

std::vector<EventMark> read_rinex_marks(const std::filesystem::path& file) {
  std::vector<EventMark> out;
  for (const RinexEvent& r : rinex_events(file)) {
    EventMark e;
    e.second = r.second;
    e.fraction = r.fraction;
    e.id = std::to_string(out.size() + 1);
    out.push_back(e);
  }
  if (out.empty())
    throw core::Error("no event: no epoch of flag 5", file.string(), "the converter from the receiver's own format must write events");
  return out;
}

std::vector<EventMark> read_marks(const std::filesystem::path& path, const EventFile& file, EventFormat format, core::Tally& tally) {
  switch (format) {
    case EventFormat::ubx:
      return read_ubx_marks(path, file.edge, file.input, tally);
    case EventFormat::novatel:
      return read_novatel_marks(path, file.input, tally);
    case EventFormat::mrk:
      return read_mrk(path, tally);
    default:
      return read_rinex_marks(path);
  }
}

}  // namespace swath::io
