// SPDX-License-Identifier: GPL-3.0-or-later
// Source: RTKLIB manual 2.4.2, appendix B.1 (positioning solution file).
#include "io/gnss/rtklib_pos.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/geo/geodesy.h"
#include "core/time.h"
#include "io/gnss/fix_list.h"
#include "io/text/line_reader.h"

namespace swath::io {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Words = std::vector<std::string_view>;

constexpr double most_junk = 0.05;  // of the lines, beside one that may be cut off
constexpr double jst = 9 * 3600.0;  // s ahead of UTC
constexpr size_t header_lines = 200;

bool has(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

/// Degrees, minutes and seconds; the sign stands with the degrees ("-0").
double degrees_of(const double* d, bool negative) {
  const double size = std::abs(d[0]) + d[1] / 60 + d[2] / 3600;
  return negative ? -size : size;
}

std::optional<Vector3d> base_of(const Words& words) {
  std::vector<double> v;
  for (const std::string_view w : words)
    if (double x; read_number(w, x)) v.push_back(x);
  if (v.size() == 3 && std::hypot(v[0], v[1], v[2]) > 1e6) return Vector3d(v[0], v[1], v[2]);
  if (v.size() == 3) return core::ecef_of({v[0] * core::degree, v[1] * core::degree, v[2]});
  if (v.size() != 7) return {};
  const auto sign = [&](size_t i) { return std::signbit(v[i]); };
  return core::ecef_of({degrees_of(&v[0], sign(0)) * core::degree, degrees_of(&v[3], sign(3)) * core::degree, v[6]});
}

/// Takes in one comment line.
void take_comment(std::string_view line, PosHeader& h) {
  const std::string_view text = line.substr(std::min(line.find_first_not_of("% \t"), line.size()));
  if (text.starts_with("(lat/lon/height=") || text.starts_with("(x/y/z-ecef=") || text.starts_with("(e/n/u-baseline=")) {
    h.above_geoid = has(text, "/geodetic");
    const size_t at = text.find('=');
    h.datum = text.substr(at + 1, text.find_first_of("/,)", at) - at - 1);
    return;
  }
  if (text.starts_with("ref pos")) {
    h.base = base_of(words_of(text.substr(std::min(text.find(':'), text.size() - 1) + 1)));
    return;
  }
  const Words words = words_of(text);
  if (words.size() < 4 || !(words[0] == "GPST" || words[0] == "UTC" || words[0] == "JST")) return;
  const bool geodetic = words[1].starts_with("latitude"), ecef = words[1].starts_with("x-ecef"), enu = words[1].starts_with("e-baseline");
  if (!geodetic && !ecef && !enu) return;
  h.stated = true;
  h.scale = words[0] == "GPST" ? PosHeader::Scale::gpst : words[0] == "UTC" ? PosHeader::Scale::utc : PosHeader::Scale::jst;
  h.place = geodetic ? PosHeader::Place::geodetic : ecef ? PosHeader::Place::ecef : PosHeader::Place::baseline;
  h.degrees_minutes = geodetic && has(words[1], "d'");
  h.columns.clear();
  for (size_t i = 4; i < words.size(); ++i) h.columns.emplace_back(words[i].substr(0, words[i].find('(')));
}

/// The columns that RTKLIB writes where no line names them.
std::vector<std::string> standard_columns() {
  return {"Q",  "ns", "sdn", "sde",  "sdu",  "sdne", "sdeu",  "sdun",  "age",  "ratio",
          "vn", "ve", "vu",  "sdvn", "sdve", "sdvu", "sdvne", "sdveu", "sdvun"};
}

constexpr int last_week = 10000;  // in 2171

/// The instant of the first two words; false where they are none.
bool time_of(const Words& words, PosHeader::Scale scale, double& time) {
  double of_epoch = 0;  // seconds since 1980-01-06 by the calendar of the file's scale
  if (has(words[0], "/")) {
    std::string date(words[0]);
    std::replace(date.begin(), date.end(), '/', '-');
    double h = 0, m = 0, s = 0;
    const size_t a = words[1].find(':'), b = words[1].rfind(':');
    if (a == std::string_view::npos || a == b || !read_number(words[1].substr(0, a), h) ||
        !read_number(words[1].substr(a + 1, b - a - 1), m) || !read_number(words[1].substr(b + 1), s))
      return false;
    const std::optional<double> t = core::gps_of_gps_date(date, h * 3600 + m * 60 + s);
    if (!t || !(*t >= 0 && *t <= core::from_week(last_week, 0))) return false;
    of_epoch = *t;
  } else {
    double week = 0, seconds = 0;
    if (!read_number(words[0], week) || !read_number(words[1], seconds) || week != std::floor(week) || !(week >= 0 && week <= last_week) ||
        !(seconds >= 0 && seconds <= core::seconds_per_week))
      return false;
    of_epoch = core::from_week(static_cast<int>(week), seconds);
  }
  const double unix_epoch = *core::unix_of_date("1980-01-06");
  time = scale == PosHeader::Scale::gpst ? of_epoch : core::from_unix(of_epoch + unix_epoch - (scale == PosHeader::Scale::jst ? jst : 0.0));
  return true;
}

/// A covariance that RTKLIB writes as a square root with the covariance's sign.
double squared(double signed_root) { return signed_root * std::abs(signed_root); }

/// Reads the columns behind the coordinates by their names.
class Columns {
 public:
  explicit Columns(const std::vector<std::string>& names) : names_(names) {}

  bool take(const Words& words, size_t first) {
    values_.assign(names_.size(), Fix::none);
    for (size_t i = 0; i < names_.size() && first + i < words.size(); ++i)
      if (!read_number(words[first + i], values_[i])) return false;
    return true;
  }
  double of(std::string_view name) const {
    const auto at = std::find(names_.begin(), names_.end(), name);
    return at == names_.end() ? Fix::none : values_[static_cast<size_t>(at - names_.begin())];
  }
  /// Covariance of axes a, b, c, whose columns are `sd` + their letters; all NaN where the file has none.
  Matrix3d covariance(const std::string& sd, char a, char b, char c) const {
    const auto mixed = [&](char p, char q) {
      const double v = of(sd + p + q);
      const double w = std::isnan(v) ? of(sd + q + p) : v;
      return std::isnan(w) ? 0.0 : squared(w);
    };
    const auto one = [&](char p) { return squared(of(sd + p)); };
    const Vector3d d(one(a), one(b), one(c));
    if (d.array().isNaN().all()) return Matrix3d::Constant(Fix::none);
    Matrix3d m;
    m << d[0], mixed(a, b), mixed(a, c), mixed(a, b), d[1], mixed(b, c), mixed(a, c), mixed(b, c), d[2];
    return m;
  }

 private:
  const std::vector<std::string>& names_;
  std::vector<double> values_;
};

void refuse_header(const PosHeader& h, const GnssFile& f, const std::string& name) {
  if (h.above_geoid || f.geoid_height)
    throw core::usage_error("the heights are above the geoid", name,
                            "write the solution with ellipsoidal heights (out-height = ellipsoidal): the geoid that was used is not known");
  if (h.datum != "WGS84") throw core::usage_error("the datum is " + h.datum, name, "write the solution on WGS84");
  if (h.place == PosHeader::Place::baseline && !f.base && !h.base)
    throw core::usage_error("baselines without the position of their base", name, "state base = [\"x m\", \"y m\", \"z m\"] (ECEF)");
}

}  // namespace

bool looks_like_pos(const std::filesystem::path& file) {
  LineReader lines(file);
  std::string_view line;
  PosHeader h;
  for (size_t i = 0; i < header_lines && lines.next(line) && line.starts_with("%"); ++i) take_comment(line, h);
  return h.stated;
}

PosHeader read_pos_header(const std::filesystem::path& file) {
  LineReader lines(file);
  std::string_view line;
  PosHeader h;
  h.columns = standard_columns();
  for (size_t i = 0; i < header_lines && lines.next(line); ++i)
    if (line.starts_with("%")) take_comment(line, h);
  return h;
}

namespace {

/// A base station's place, as ECEF and geodetic.
struct BasePlace {
  Vector3d ecef;
  core::Geodetic geodetic = core::geodetic_of(ecef);
};

/// Place, velocity and covariances of a line from its coordinates `c`.
void place_fix(const PosHeader& h, const Columns& columns, const Words& words, const double* c, const BasePlace& base, Fix& fix) {
  core::Geodetic g;
  Vector3d velocity(columns.of("vn"), columns.of("ve"), columns.of("vu"));
  switch (h.place) {
    case PosHeader::Place::geodetic: {
      const double latitude = h.degrees_minutes ? degrees_of(c, words[2].starts_with("-")) : c[0];
      const double longitude = h.degrees_minutes ? degrees_of(c + 3, words[5].starts_with("-")) : c[1];
      if (std::abs(latitude) > 90 || std::abs(longitude) > 360) {
        fix.fault = "latitude " + core::format_number(latitude) + ", longitude " + core::format_number(longitude) + " are no degrees";
        fix.hint = "the file's header does not name its columns";
      }
      g = {latitude * core::degree, longitude * core::degree, c[h.degrees_minutes ? 6 : 2]};
      fix.position = core::ecef_of(g);
      break;
    }
    case PosHeader::Place::ecef:
      fix.position = {c[0], c[1], c[2]};
      break;
    case PosHeader::Place::baseline:
      g = base.geodetic;
      fix.position = base.ecef + ecef_vector({c[1], c[0], c[2]}, g.latitude, g.longitude);
      break;
  }
  if (h.place == PosHeader::Place::ecef) {
    fix.covariance = columns.covariance("sd", 'x', 'y', 'z');
    fix.velocity = {columns.of("vx"), columns.of("vy"), columns.of("vz")};
    fix.velocity_covariance = columns.covariance("sdv", 'x', 'y', 'z');
  } else {
    fix.covariance = ecef_covariance(columns.covariance("sd", 'n', 'e', 'u'), g.latitude, g.longitude);
    fix.velocity = ecef_vector(velocity, g.latitude, g.longitude);
    fix.velocity_covariance = ecef_covariance(columns.covariance("sdv", 'n', 'e', 'u'), g.latitude, g.longitude);
  }
}

}  // namespace

core::GnssData read_pos(const std::filesystem::path& path, const GnssFile& f, double latency, core::Tally& tally) {
  const std::string name = path.string();
  const PosHeader h = read_pos_header(path);
  refuse_header(h, f, name);
  const BasePlace base{f.base ? Vector3d((*f.base)[0].value, (*f.base)[1].value, (*f.base)[2].value) : h.base.value_or(Vector3d::Zero())};
  const size_t coordinates = h.degrees_minutes ? 7 : 3;
  FixList fixes(f, name, latency + f.time.offset.value, false, tally);
  Columns columns(h.columns);
  LineReader lines(path);
  std::string_view line;
  std::uint64_t read = 0, junk = 0, good_ones = 0;
  while (lines.next(line)) {
    const Words words = words_of(line);
    if (words.empty() || line.starts_with("%")) continue;
    ++read;
    Fix fix;
    double c[7] = {};
    bool good = words.size() >= 2 + coordinates + 1 && time_of(words, h.scale, fix.time);
    for (size_t i = 0; good && i < coordinates; ++i) good = read_number(words[2 + i], c[i]);
    if (!good || !columns.take(words, 2 + coordinates)) {
      ++junk;
      tally.count("RTKLIB lines that are no solution, left out", lines.place());
      continue;
    }
    if (columns.of("Q") == 0) {
      tally.count("RTKLIB lines of epochs without a solution, left out", lines.place());
      continue;
    }
    fix.quality = quality_of_rtklib(columns.of("Q"));
    fix.satellites = columns.of("ns");
    place_fix(h, columns, words, c, base, fix);
    fixes.add(fix, lines.number());
    ++good_ones;
  }
  tally.read("RTKLIB lines", read);
  tally.keep("RTKLIB lines", good_ones);
  if (static_cast<double>(junk) > 1 + most_junk * static_cast<double>(read))
    throw core::Error(std::to_string(junk) + " of " + std::to_string(read) + " lines are no solution of RTKLIB", name,
                      "state the format of the file, or write it again");
  return fixes.finish();
}

}  // namespace swath::io
