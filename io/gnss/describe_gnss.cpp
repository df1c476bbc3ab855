// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/describe_gnss.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/error.h"
#include "core/geo/geodesy.h"
#include "core/statistics.h"
#include "core/time.h"
#include "io/gnss/gnss_file.h"
#include "io/gnss/nmea.h"
#include "io/gnss/rinex_header.h"
#include "io/gnss/rtklib_pos.h"
#include "io/survey/record_times.h"
#include "io/text/binary_file.h"

namespace swath::io {
namespace {

using core::FixQuality;
using core::Value;

constexpr std::string_view tag_magic = "TIMETAG RTKLIB";
constexpr size_t tag_header = 76, tag_record = 8;  // bytes: text and tick 64, time 12; tick and place 4 each

Value interval(double low, double high) { return Value(Value::Array{low, high}); }

/// Fixes as a table; what the reader counted becomes the warnings.
void put_fixes(const core::GnssData& g, Value& out) {
  out["fixes"] = static_cast<std::uint64_t>(g.size());
  Value& by = out["fixes_by_quality"] = Value::object();
  for (size_t q = 0; q < core::Choices<FixQuality>::names.size(); ++q)
    if (const auto n = std::count(g.quality.begin(), g.quality.end(), static_cast<FixQuality>(q)))
      by[std::string(core::Choices<FixQuality>::names[q])] = static_cast<std::uint64_t>(n);
  out["from"] = core::utc_text(g.time.front());
  out["to"] = core::utc_text(g.time.back());
  out["seconds"] = std::round((g.time.back() - g.time.front()) * 1e3) / 1e3;
  std::vector<double> steps;
  for (size_t k = 1; k < g.size(); ++k) steps.push_back(g.time[k] - g.time[k - 1]);
  if (!steps.empty()) out["rate_hz"] = std::round(1e3 / core::median(steps)) / 1e3;
  std::array<double, 3> low, high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-low[0]);
  std::vector<double> horizontal, vertical;
  for (size_t k = 0; k < g.size(); ++k) {
    const core::Geodetic p = core::geodetic_of(g.position[k]);
    const std::array<double, 3> at{core::to_degrees(p.latitude), core::to_degrees(p.longitude), p.height};
    for (size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], at[c]);
      high[c] = std::max(high[c], at[c]);
    }
    const Eigen::Matrix3d R = core::ecef_R_ned(p.latitude, p.longitude);
    const Eigen::Vector3d variance = (R.transpose() * g.covariance[k] * R).diagonal();
    horizontal.push_back(std::sqrt(0.5 * (variance[0] + variance[1])));
    vertical.push_back(std::sqrt(variance[2]));
  }
  out["latitude_deg"] = interval(low[0], high[0]);
  out["longitude_deg"] = interval(low[1], high[1]);
  out["ellipsoidal_height_m"] = interval(low[2], high[2]);
  out["median_sigma_horizontal_m"] = core::median(horizontal);
  out["median_sigma_height_m"] = core::median(vertical);
  out["velocities"] = g.has_velocity();
}

void put_warnings(const core::Tally& tally, Value warnings, Value& out) {
  const Value counted = tally.value();
  for (const auto& [what, told] : counted.members()) {
    if (what.starts_with("GNSS fixes: ")) continue;
    std::string text = what + ": " + std::to_string(told.find("count")->as_int());
    if (const Value* examples = told.find("examples")) text += " (" + examples->items()[0].as_text() + ")";
    warnings.push(std::move(text));
  }
  out["warnings"] = std::move(warnings);
}

GnssFile file_of(const std::filesystem::path& path, GnssFormat format) {
  GnssFile f;
  f.file = std::filesystem::absolute(path);
  f.format = format;
  return f;
}

/// Fixes of a file that may lack what only a survey can state.
void read_fixes(const GnssFile& f, Value& out) {
  core::Tally tally;
  Value warnings = Value::array();
  try {
    put_fixes(read_gnss(Survey{}, f, tally), out);
  } catch (const core::Error& e) {
    warnings.push(e.what() + (e.hint().empty() ? std::string{} : ": " + e.hint()));
  }
  put_warnings(tally, std::move(warnings), out);
}

}  // namespace

Value describe_pos(const std::filesystem::path& path) {
  const PosHeader h = read_pos_header(path);
  Value out = Value::object();
  out["format"] = "RTKLIB solution";
  out["coordinates"] = h.place == PosHeader::Place::geodetic ? "latitude, longitude, height"
                       : h.place == PosHeader::Place::ecef   ? "ECEF"
                                                             : "baseline east, north, up";
  out["time_scale"] = h.scale == PosHeader::Scale::gpst ? "GPST" : h.scale == PosHeader::Scale::utc ? "UTC" : "JST";
  if (h.place == PosHeader::Place::geodetic) out["heights"] = h.above_geoid ? "above the geoid" : "ellipsoidal";
  read_fixes(file_of(path, GnssFormat::pos), out);
  return out;
}

Value describe_nmea(const std::filesystem::path& path) {
  core::Tally ignored;
  const NmeaFile file = scan_nmea(path, ignored);
  Value out = Value::object();
  out["format"] = "NMEA";
  Value& sentences = out["sentences"] = Value::object();
  for (const auto& [kind, n] : file.sentences) sentences[kind] = n;
  read_fixes(file_of(path, GnssFormat::nmea), out);
  return out;
}

bool looks_like_tag(const std::filesystem::path& path) {
  const BinaryFile file(path);
  std::array<char, tag_magic.size()> start{};
  return file.size() >= tag_header && file.read_some(0, start.data(), start.size()) == start.size() &&
         std::string_view(start.data(), start.size()) == tag_magic;
}

Value describe_tag(const std::filesystem::path& path) {
  const BinaryFile file(path);
  std::array<unsigned char, tag_header> header{};
  file.read(0, header.data(), header.size());
  // POSIX numbers of a GPS date: RTKLIB keeps instants that way.
  const double gps_date = load<std::uint32_t>(&header[64]) + load<double>(&header[68]);
  const double start = gps_date - *core::unix_of_date("1980-01-06");
  Value out = Value::object(), warnings = Value::array();
  out["format"] = "RTKLIB time tags";
  // By the GPS calendar: the date of the same number without leap seconds.
  std::string civil = core::utc_text(core::from_unix(gps_date));
  civil.pop_back();
  out["recording_began"] = civil + " GPS";
  out["seconds_of_week"] = core::seconds_of_week(start);
  out["gps_week"] = core::week_of(start);
  const std::uint64_t records = (file.size() - tag_header) / tag_record;
  out["tags"] = records;
  std::array<unsigned char, tag_record> record{};
  for (const auto& [name, index] : {std::pair{"first_arrival_s", std::uint64_t{0}}, {"last_arrival_s", records - 1}}) {
    if (records == 0) break;
    file.read(tag_header + index * tag_record, record.data(), record.size());
    out[name] = load<std::uint32_t>(record.data()) * 1e-3;
  }
  if (records == 0) warnings.push("no arrival is recorded");
  out["warnings"] = std::move(warnings);
  return out;
}

Value describe_rinex(const std::filesystem::path& path) {
  Value out = Value::object(), warnings = Value::array();
  const RinexKind kind = rinex_kind(path);
  out["format"] = kind == RinexKind::orbits ? "SP3 orbits" : "RINEX";
  if (kind == RinexKind::navigation || kind == RinexKind::clocks)
    out["kind"] = kind == RinexKind::navigation ? "navigation messages" : "clocks";
  if (kind == RinexKind::observations) {
    out["kind"] = "observations";
    try {
      const RinexObservations o = scan_rinex(path);
      const RinexHeader& h = o.header;
      out["version"] = h.version;
      out["systems"] = std::string(1, h.system);
      out["marker"] = h.marker;
      out["antenna"] = h.antenna_type;
      out["antenna_offset_enu_m"] = Value(Value::Array{h.antenna_offset.x(), h.antenna_offset.y(), h.antenna_offset.z()});
      if (h.position) {
        const core::Geodetic g = core::geodetic_of(*h.position);
        out["approximate_latitude_deg"] = core::to_degrees(g.latitude);
        out["approximate_longitude_deg"] = core::to_degrees(g.longitude);
        out["approximate_ellipsoidal_height_m"] = g.height;
      } else {
        warnings.push("the header states no approximate position");
      }
      out["epochs"] = o.epochs;
      out["interval_s"] = o.interval;
      out["from"] = core::utc_text(o.first);
      out["to"] = core::utc_text(o.last);
      out["seconds"] = std::round((o.last - o.first) * 1e3) / 1e3;
      out["longest_gap_s"] = o.longest_gap;
      if (o.interval > 0 && o.longest_gap > 1.5 * o.interval) warnings.push("epochs are missing");
    } catch (const core::Error& e) {
      warnings.push(e.text());
    }
  }
  out["warnings"] = std::move(warnings);
  return out;
}

}  // namespace swath::io
