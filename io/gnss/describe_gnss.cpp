// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/describe_gnss.h"

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/interval.h"
#include "core/config/result_visitors.h"
#include "core/error.h"
#include "core/geo/geodesy.h"
#include "core/records/fix_counts.h"
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

using core::Value;
using namespace std::string_literals;

constexpr std::string_view tag_magic = "TIMETAG RTKLIB";
constexpr size_t tag_header = 76, tag_record = 8;  // bytes: text and tick 64, time 12; tick and place 4 each

double to_millis(double v) { return std::round(v * 1e3) / 1e3; }

/// Fixes of a file; there are none where it cannot be read without a survey.
struct FixFacts {
  std::uint64_t fixes = 0;
  core::FixCounts by_quality{};
  std::string from, to;
  double seconds = 0.0;
  std::optional<double> rate{};
  core::Interval latitude{}, longitude{}, height{};
  double sigma_horizontal = 0.0, sigma_height = 0.0;
  bool velocities = false;
  std::vector<std::string> warnings{};
};

template <class V>
void describe(const FixFacts& r, V& v) {
  const auto known = [&r](core::Form f = {}) { return f.always().only_if(r.fixes > 0); };
  v.result("fixes", r.fixes, known(), "Positions.");
  v.table("fixes_by_quality", r.fixes > 0 ? std::optional(r.by_quality) : std::nullopt, "Fixes by how they were computed.");
  v.result("from", r.from, known(), "UTC of the first.");
  v.result("to", r.to, known(), "UTC of the last.");
  v.result("seconds", r.seconds, known(core::seconds()), "Time from the first to the last.");
  v.result("rate_hz", r.rate, core::Form{"Hz"}, "Fixes per second, by the median step.");
  v.result("latitude_deg", r.latitude, "Smallest and largest latitude.");
  v.result("longitude_deg", r.longitude, "Smallest and largest longitude.");
  v.result("ellipsoidal_height_m", r.height, "Smallest and largest height.");
  v.result("median_sigma_horizontal_m", r.sigma_horizontal, known(core::metres()), "Median sigma of an axis on the map.");
  v.result("median_sigma_height_m", r.sigma_height, known(core::metres()), "Median sigma of the height.");
  v.result("velocities", r.velocities, known(), "Do fixes state a velocity?");
  v.result("warnings", r.warnings, "What looks wrong.");
}

void find_fixes(const core::GnssData& g, FixFacts& out) {
  out.fixes = g.size();
  for (const core::FixQuality q : g.quality) out.by_quality.add(q);
  out.from = core::utc_text(g.time.front());
  out.to = core::utc_text(g.time.back());
  out.seconds = to_millis(g.time.back() - g.time.front());
  std::vector<double> steps, horizontal, vertical;
  for (size_t k = 1; k < g.size(); ++k) steps.push_back(g.time[k] - g.time[k - 1]);
  if (!steps.empty()) out.rate = std::round(1e3 / core::median(steps)) / 1e3;
  for (size_t k = 0; k < g.size(); ++k) {
    const core::Geodetic p = core::geodetic_of(g.position[k]);
    out.latitude.add(core::to_degrees(p.latitude));
    out.longitude.add(core::to_degrees(p.longitude));
    out.height.add(p.height);
    const Eigen::Matrix3d R = core::ecef_R_ned(p.latitude, p.longitude);
    const Eigen::Vector3d variance = (R.transpose() * g.covariance[k] * R).diagonal();
    horizontal.push_back(std::sqrt(0.5 * (variance[0] + variance[1])));
    vertical.push_back(std::sqrt(variance[2]));
  }
  out.sigma_horizontal = core::median(horizontal);
  out.sigma_height = core::median(vertical);
  out.velocities = g.has_velocity();
}

GnssFile file_of(const std::filesystem::path& path, GnssFormat format) {
  GnssFile f;
  f.file = std::filesystem::absolute(path);
  f.format = format;
  return f;
}

/// Fixes of a file that may lack what only a survey can state; what the reader counts becomes warnings.
FixFacts facts_of(const std::filesystem::path& path, GnssFormat format) {
  FixFacts out;
  core::Tally tally;
  try {
    find_fixes(read_gnss(Survey{}, file_of(path, format), tally), out);
  } catch (const core::Error& e) {
    out.warnings.push_back(e.what() + (e.hint().empty() ? std::string{} : ": " + e.hint()));
  }
  const Value counted = tally.value();
  for (const auto& [what, entry] : counted.members()) {
    if (what.starts_with("GNSS fixes: ")) continue;
    std::string text = what + ": " + std::to_string(entry.find("count")->as_int());
    if (const Value* examples = entry.find("examples")) text += " (" + examples->items()[0].as_text() + ")";
    out.warnings.push_back(std::move(text));
  }
  return out;
}

struct PosFacts {
  const PosHeader& header;
  FixFacts fixes;
};
template <class V>
void describe(const PosFacts& r, V& v) {
  const PosHeader& h = r.header;
  const bool geodetic = h.place == PosHeader::Place::geodetic;
  v.result("format", "RTKLIB solution"s, "Format.");
  v.result("coordinates",
           geodetic                            ? "latitude, longitude, height"s
           : h.place == PosHeader::Place::ecef ? "ECEF"s
                                               : "baseline east, north, up"s,
           "What the positions are.");
  v.result("time_scale",
           h.scale == PosHeader::Scale::gpst  ? "GPST"s
           : h.scale == PosHeader::Scale::utc ? "UTC"s
                                              : "JST"s,
           "Scale of the times.");
  v.result("heights", h.above_geoid ? "above the geoid"s : "ellipsoidal"s, core::plain().only_if(geodetic), "What heights count from.");
  describe(r.fixes, v);
}

struct SentenceCount {
  std::string name;
  std::uint64_t count = 0;
};
template <class V>
void describe(const SentenceCount& r, V& v) {
  v.result("name", r.name, "Kind of the sentence: GGA, RMC ...");
  v.result("count", r.count, "How many there are.");
}

struct NmeaFacts {
  std::vector<SentenceCount> sentences;
  FixFacts fixes;
};
template <class V>
void describe(const NmeaFacts& r, V& v) {
  v.result("format", "NMEA"s, "Format.");
  v.tables("sentences", r.sentences, "Sentences by kind.");
  describe(r.fixes, v);
}

struct TagFacts {
  std::string began;
  double seconds_of_week = 0.0;
  int week = 0;
  std::uint64_t tags = 0;
  std::optional<double> first{}, last{};
  std::vector<std::string> warnings{};
};
template <class V>
void describe(const TagFacts& r, V& v) {
  v.result("format", "RTKLIB time tags"s, "Format.");
  v.result("recording_began", r.began, "Start of the recording, GPS date.");
  v.result("seconds_of_week", r.seconds_of_week, "The same in seconds of the GPS week.");
  v.result("gps_week", r.week, "GPS week.");
  v.result("tags", r.tags, "Arrivals.");
  v.result("first_arrival_s", r.first, core::seconds(), "First arrival after the start.");
  v.result("last_arrival_s", r.last, core::seconds(), "Last arrival after the start.");
  v.result("warnings", r.warnings, "What looks wrong.");
}

struct ObservationFacts {
  const RinexObservations& o;
};
template <class V>
void describe(const ObservationFacts& r, V& v) {
  const RinexObservations& o = r.o;
  const RinexHeader& h = o.header;
  const core::Geodetic g = h.position ? core::geodetic_of(*h.position) : core::Geodetic{};
  const auto placed = core::plain().always().only_if(h.position.has_value());
  v.result("version", h.version, "Version of RINEX.");
  v.result("systems", std::string(1, h.system), "Satellite systems.");
  v.result("marker", h.marker, "Name of the station.");
  v.result("antenna", h.antenna_type, "Type of the antenna.");
  v.result("antenna_offset_enu_m", h.antenna_offset, "Antenna over the marker: east, north, up.");
  v.result("approximate_latitude_deg", core::to_degrees(g.latitude), placed, "Approximate latitude.");
  v.result("approximate_longitude_deg", core::to_degrees(g.longitude), placed, "Approximate longitude.");
  v.result("approximate_ellipsoidal_height_m", g.height, placed, "Approximate height.");
  v.result("epochs", o.epochs, "Epochs.");
  v.result("interval_s", o.interval, core::seconds().always(), "Usual step between epochs.");
  v.result("from", core::utc_text(o.first), "UTC of the first epoch.");
  v.result("to", core::utc_text(o.last), "UTC of the last epoch.");
  v.result("seconds", to_millis(o.last - o.first), core::seconds(), "Time from the first to the last.");
  v.result("longest_gap_s", o.longest_gap, core::seconds().always(), "Longest step between epochs.");
  v.result("events", o.events, core::if_any(), "External events (epochs of flag 5).");
}

struct RinexFacts {
  RinexKind kind;
  std::optional<RinexObservations> observations{};
  std::vector<std::string> warnings{};
};
template <class V>
void describe(const RinexFacts& r, V& v) {
  const bool navigation = r.kind == RinexKind::navigation, clocks = r.kind == RinexKind::clocks;
  const bool observations = r.kind == RinexKind::observations;
  v.result("format", r.kind == RinexKind::orbits ? "SP3 orbits"s : "RINEX"s, "Format.");
  v.result("kind",
           navigation ? "navigation messages"s
           : clocks   ? "clocks"s
                      : "observations"s,
           core::plain().only_if(navigation || clocks || observations), "What it holds.");
  if (r.observations) describe(ObservationFacts{*r.observations}, v);
  v.result("warnings", r.warnings, "What looks wrong.");
}

}  // namespace

Value describe_pos(const std::filesystem::path& path) {
  const PosHeader h = read_pos_header(path);
  return core::reported(PosFacts{h, facts_of(path, GnssFormat::pos)});
}

Value describe_nmea(const std::filesystem::path& path) {
  core::Tally ignored;
  NmeaFacts out;
  for (const auto& [kind, n] : scan_nmea(path, ignored).sentences) out.sentences.push_back({kind, n});
  out.fixes = facts_of(path, GnssFormat::nmea);
  return core::reported(out);
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
  // By the GPS calendar: the date of the same number without leap seconds.
  std::string civil = core::utc_text(core::from_unix(gps_date));
  civil.pop_back();
  TagFacts out{civil + " GPS", core::seconds_of_week(start), core::week_of(start), (file.size() - tag_header) / tag_record};
  const auto arrival = [&](std::uint64_t index) {
    std::array<unsigned char, tag_record> record{};
    file.read(tag_header + index * tag_record, record.data(), record.size());
    return load<std::uint32_t>(record.data()) * 1e-3;
  };
  if (out.tags > 0) {
    out.first = arrival(0);
    out.last = arrival(out.tags - 1);
  } else {
    out.warnings.push_back("no arrival is recorded");
  }
  return core::reported(out);
}

Value describe_rinex(const std::filesystem::path& path) {
  RinexFacts out{rinex_kind(path)};
  if (out.kind == RinexKind::observations) try {
      const RinexObservations& o = out.observations.emplace(scan_rinex(path));
      if (!o.header.position) out.warnings.push_back("the header states no approximate position");
      if (o.interval > 0 && o.longest_gap > 1.5 * o.interval) out.warnings.push_back("epochs are missing");
    } catch (const core::Error& e) {
      out.warnings.push_back(e.text());
    }
  return core::reported(out);
}

}  // namespace swath::io
