// SPDX-License-Identifier: GPL-3.0-or-later
// Coordinate reference systems through PROJ's C interface. PROJ objects are made in a context of their own with the log and the network
// off, and never shared between threads: a Crs keeps only plain facts and its definition.
#include "core/geo/crs.h"

#include <proj_experimental.h>  // proj_crs_promote_to_3D, proj_crs_demote_to_2D

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "core/error.h"
#include "core/geo/proj_handles.h"
#include "core/printable.h"

namespace swath::core {

namespace {

constexpr std::string_view ellipsoidal_suffix = "ellipsoidal";

// Trimmed, "EPSG:a+EPSG:b" as "EPSG:a+b", PROJ text marked as a CRS.
std::string tidy(const std::string& given) {
  constexpr const char* blanks = " \t\r\n";
  std::string d = given.substr(0, given.find('\0'));
  const size_t first = d.find_first_not_of(blanks);
  if (first == std::string::npos) return {};
  d = d.substr(first, d.find_last_not_of(blanks) - first + 1);
  const auto is_epsg = [&](size_t at) {
    return d.size() >= at + 5 &&
           std::equal(d.begin() + at, d.begin() + at + 5, "EPSG:", [](char a, char b) { return std::toupper(a) == b; });
  };
  if (is_epsg(0)) {
    const size_t plus = d.find('+');
    if (plus != std::string::npos && is_epsg(plus + 1)) d.erase(plus + 1, 5);
  } else if ((d.find("+proj=") != std::string::npos || d.find("+init=") != std::string::npos) && d.find("type=crs") == std::string::npos &&
             d.find("+proj=pipeline") == std::string::npos) {
    d += " +type=crs";
  }
  // "@" would make a geoid optional, and heights pass through untouched without it; here a geoid that is named is needed.
  const size_t at = d.find("+geoidgrids=@");
  if (at != std::string::npos) d.erase(at + 12, 1);
  return d;
}

std::string hint_for(const std::string& d) {
  if (!d.empty() && d.find_first_not_of("0123456789") == std::string::npos) return "write the authority too: \"EPSG:" + d + "\"";
  if (d.find('+') != std::string::npos && d.find("+proj") == std::string::npos)
    return "a compound is a two-dimensional CRS and a vertical one, such as \"EPSG:25832+7837\" (or \"EPSG:25832+ellipsoidal\"); look "
           "codes up "
           "with `projinfo`";
  if (d.find("[") != std::string::npos) return "the WKT is damaged or of a kind PROJ does not read; give an EPSG code instead";
  return "give an EPSG code (\"EPSG:32632\", compound \"EPSG:25832+7837\"), WKT or PROJ text; if every code fails, proj.db is not found: "
         "set "
         "PROJ_DATA to its folder";
}

bool is_in_database(PJ_CONTEXT* c, const std::string& authority, const std::string& code) {
  return Pj(proj_create_from_database(c, authority.c_str(), code.c_str(), PJ_CATEGORY_CRS, 0, nullptr)) != nullptr;
}

/// Throws for a definition by codes of which PROJ's database does not hold one. Without the database every code is unknown.
void check_codes(PJ_CONTEXT* c, const std::string& d) {
  const size_t colon = d.find(':');
  if (colon == std::string::npos || d.find_first_not_of("0123456789+", colon + 1) != std::string::npos) return;
  std::string authority = d.substr(0, colon);
  std::transform(authority.begin(), authority.end(), authority.begin(), [](unsigned char a) { return std::toupper(a); });
  if (!is_in_database(c, "EPSG", "4326")) return;
  for (size_t at = colon + 1; at < d.size();) {
    const size_t end = std::min(d.find('+', at), d.size());
    const std::string code = d.substr(at, end - at);
    at = end + 1;
    if (code.empty() || is_in_database(c, authority, code)) continue;
    const std::string other = authority == "EPSG" ? "ESRI" : "EPSG";
    throw Error("PROJ's database does not hold the CRS \"" + authority + ":" + code + "\"", {},
                is_in_database(c, other, code)
                    ? "the code is one of " + other + "'s: \"" + other + ":" + code + "\""
                    : "look the code up: `projinfo --list-crs`, or https://epsg.org; newer codes need a newer PROJ");
  }
}

/// "EPSG:32632+ellipsoidal": takes the suffix off.
bool take_ellipsoidal(std::string& d) {
  const std::string small = lower_case(d);
  const size_t plus = small.rfind('+');
  if (plus == std::string::npos || plus == 0) return false;
  const size_t word = small.find_first_not_of(' ', plus + 1);
  if (word == std::string::npos || small.substr(word) != ellipsoidal_suffix) return false;
  d = tidy(d.substr(0, plus));
  return true;
}

// The CRS inside a bound CRS (one that carries its own shift to WGS 84).
Pj unbound(PJ_CONTEXT* c, Pj crs) {
  while (crs && proj_get_type(crs.get()) == PJ_TYPE_BOUND_CRS) crs = Pj(proj_get_source_crs(c, crs.get()));
  return crs;
}

// Axis `index` of a CRS; the metre where it has no such axis.
CrsAxis axis_of(PJ_CONTEXT* c, const PJ* crs, int index) {
  CrsAxis axis;
  const Pj cs(proj_crs_get_coordinate_system(c, crs));
  if (!cs || index >= proj_cs_get_axis_count(c, cs.get())) return axis;
  const char* unit = nullptr;
  if (proj_cs_get_axis_info(c, cs.get(), index, nullptr, nullptr, nullptr, &axis.factor, &unit, nullptr, nullptr))
    axis.unit = proj_text(unit);
  return axis;
}

int code_of(const PJ* crs) {
  if (proj_text(proj_get_id_auth_name(crs, 0)) != "EPSG") return 0;
  return std::atoi(proj_text(proj_get_id_code(crs, 0)).c_str());
}

std::string datum_name(PJ_CONTEXT* c, const PJ* crs) {
  Pj datum(proj_crs_get_datum(c, crs));
  if (!datum) datum = Pj(proj_crs_get_datum_ensemble(c, crs));
  return proj_text(proj_get_name(datum ? datum.get() : crs));
}

/// Is the CRS one of a datum that is known by its code? Its own shift to WGS 84 (TOWGS84 of WKT) then says less than PROJ's database.
bool has_known_datum(PJ_CONTEXT* c, const PJ* crs) {
  const Pj geodetic(proj_crs_get_geodetic_crs(c, crs));
  if (!geodetic) return false;
  if (code_of(crs) != 0 || code_of(geodetic.get()) != 0) return true;
  Pj datum(proj_crs_get_datum(c, geodetic.get()));
  if (!datum) datum = Pj(proj_crs_get_datum_ensemble(c, geodetic.get()));
  return datum && code_of(datum.get()) != 0;
}

/// Without the shift that software writes into WKT beside a known datum, as GDAL reads it; null where there is none to take off.
Pj without_needless_shift(PJ_CONTEXT* c, const PJ* crs) {
  if (proj_get_type(crs) == PJ_TYPE_BOUND_CRS) {
    Pj source(proj_get_source_crs(c, crs));
    if (source && proj_get_type(source.get()) != PJ_TYPE_VERTICAL_CRS && has_known_datum(c, source.get())) return source;
    return nullptr;
  }
  if (proj_get_type(crs) != PJ_TYPE_COMPOUND_CRS) return nullptr;
  const Pj horizontal(proj_crs_get_sub_crs(c, crs, 0)), vertical(proj_crs_get_sub_crs(c, crs, 1));
  const Pj plain = horizontal ? without_needless_shift(c, horizontal.get()) : nullptr;
  return plain ? Pj(proj_create_compound_crs(c, proj_get_name(crs), plain.get(), vertical.get())) : nullptr;
}

/// A vertical part that names a unit alone: "unknown" and the like, as GeoTIFF keys without a vertical system are read.
bool is_unknown_datum(const PJ* vertical, const std::string& datum) {
  if (code_of(vertical) != 0) return false;
  const std::string name = lower_case(datum);
  return name.empty() || name.starts_with("unknown") || name.starts_with("unnamed") || name.starts_with("undefined") ||
         name.starts_with("not specified");
}

std::string wkt_of(PJ_CONTEXT* c, const PJ* crs, PJ_WKT_TYPE type, bool vertical_of_ellipsoid = false) {
  const char* const options[] = {"MULTILINE=NO", vertical_of_ellipsoid ? "ALLOW_ELLIPSOIDAL_HEIGHT_AS_VERTICAL_CRS=YES" : nullptr, nullptr};
  return proj_text(proj_as_wkt(c, crs, type, options));
}

/// The CRS that a text means, with its needless shift taken off and its third axis put on where ellipsoidal heights are asked for.
Pj made_from(PJ_CONTEXT* c, CrsFacts& s) {
  const bool ellipsoidal = take_ellipsoidal(s.definition);
  Pj crs = parse_crs(c, s.definition);
  if (!crs) {
    const std::string why = proj_reason(c);
    check_codes(c, s.definition);
    throw Error("PROJ does not know the CRS \"" + short_form(s.definition) + "\"" + (why.empty() ? "" : " (" + why + ")"), {},
                hint_for(s.definition));
  }
  if (!proj_is_crs(crs.get()))
    throw Error("\"" + short_form(s.definition) + "\" is not a coordinate reference system", {}, hint_for(s.definition));
  if (Pj plain = without_needless_shift(c, crs.get())) {
    crs = std::move(plain);
    s.definition = wkt_of(c, crs.get(), PJ_WKT2_2019);
  }
  if (!ellipsoidal) return crs;
  if (proj_get_type(crs.get()) == PJ_TYPE_COMPOUND_CRS)
    throw Error("\"" + short_form(s.definition) + "\" has a vertical part already: its heights cannot be ellipsoidal too", {},
                "name the horizontal CRS alone before +ellipsoidal");
  s.epsg = code_of(crs.get());
  crs = Pj(proj_crs_promote_to_3D(c, nullptr, crs.get()));
  s.definition = wkt_of(c, crs.get(), PJ_WKT2_2019);
  return crs;
}

/// Heights and their axis.
void read_heights(PJ_CONTEXT* c, const PJ* crs, const PJ* horizontal, CrsFacts& s) {
  s.vertical = proj_get_type(crs) == PJ_TYPE_COMPOUND_CRS;
  if (s.vertical) {
    const Pj part(proj_crs_get_sub_crs(c, crs, 1));
    const bool has_geoid = proj_get_type(part.get()) == PJ_TYPE_BOUND_CRS;  // a grid of its own, +geoidgrids
    const Pj vertical = unbound(c, Pj(proj_clone(c, part.get())));
    s.vertical_epsg = code_of(vertical.get());
    s.vertical_name = datum_name(c, vertical.get());
    s.vertical_axis = axis_of(c, vertical.get(), 0);
    s.heights = !has_geoid && is_unknown_datum(vertical.get(), s.vertical_name) ? Heights::unknown : Heights::vertical;
  } else {
    const Pj axes(proj_crs_get_coordinate_system(c, horizontal));
    s.vertical_axis = axis_of(c, horizontal, 2);
    s.heights = axes && proj_cs_get_axis_count(c, axes.get()) == 3 ? Heights::ellipsoidal : Heights::unknown;
  }
  if (s.heights != Heights::vertical)
    s.vertical_name = std::string(s.heights == Heights::ellipsoidal ? ellipsoidal_heights : unknown_heights);
}

}  // namespace

Crs::Crs(const std::string& given) {
  auto s = std::make_shared<CrsFacts>();
  s->definition = tidy(given);
  const ProjContext context = new_proj_context();
  PJ_CONTEXT* c = context.get();
  if (s->definition.empty()) throw Error("the CRS is empty", {}, hint_for({}));
  const Pj crs = made_from(c, *s);
  s->name = proj_text(proj_get_name(crs.get()));
  s->wkt = wkt_of(c, crs.get(), PJ_WKT2_2019);

  Pj whole = unbound(c, Pj(proj_clone(c, crs.get())));
  Pj horizontal = proj_get_type(whole.get()) == PJ_TYPE_COMPOUND_CRS ? unbound(c, Pj(proj_crs_get_sub_crs(c, whole.get(), 0)))
                                                                     : Pj(proj_clone(c, whole.get()));
  read_heights(c, whole.get(), horizontal.get(), *s);
  if (s->epsg == 0) s->epsg = code_of(horizontal.get());
  const PJ_TYPE type = proj_get_type(horizontal.get());
  s->geographic = type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
  s->geocentric = type == PJ_TYPE_GEOCENTRIC_CRS;
  s->projected = type == PJ_TYPE_PROJECTED_CRS;
  if (!s->geographic && !s->geocentric && !s->projected)
    throw Error("\"" + s->name + "\" is neither projected, geographic nor geocentric", {},
                type == PJ_TYPE_VERTICAL_CRS ? "join it to a horizontal CRS: \"EPSG:25832+7837\"" : hint_for(s->definition));
  s->wkt1 = wkt_of(c, crs.get(), PJ_WKT1_GDAL, s->projected && s->heights == Heights::ellipsoidal);
  if (s->wkt1.empty()) s->wkt1 = s->wkt;
  s->horizontal_wkt = s->wkt;
  if (s->vertical) {  // with a shift of its own, where it has one
    s->horizontal_wkt = wkt_of(c, Pj(proj_crs_get_sub_crs(c, whole.get(), 0)).get(), PJ_WKT2_2019);
  } else if (s->heights == Heights::ellipsoidal && !s->geocentric) {
    if (const Pj flat(proj_crs_demote_to_2D(c, nullptr, crs.get())); flat) s->horizontal_wkt = wkt_of(c, flat.get(), PJ_WKT2_2019);
  }
  s->horizontal_axis = axis_of(c, horizontal.get(), 0);
  if (s->geographic) s->horizontal_axis.factor = 0.0;
  double* a = s->area;
  s->has_area = proj_get_area_of_use(c, crs.get(), &a[0], &a[1], &a[2], &a[3], nullptr) && a[0] > -1000.0;
  if (!s->has_area) s->has_area = proj_get_area_of_use(c, horizontal.get(), &a[0], &a[1], &a[2], &a[3], nullptr) && a[0] > -1000.0;
  facts_ = std::move(s);
}

const CrsFacts& Crs::facts() const {
  if (!facts_) throw Error("a CRS is needed and none is given", {}, "state it: \"EPSG:32632\", \"EPSG:25832+7837\", WKT or PROJ text");
  return *facts_;
}

std::string Crs::name() const { return facts().name; }
std::string Crs::wkt() const { return facts().wkt; }
std::string Crs::wkt1() const { return facts().wkt1; }
int Crs::epsg() const { return facts().epsg; }
int Crs::vertical_epsg() const { return facts().vertical_epsg; }
bool Crs::is_geographic() const { return facts().geographic; }
bool Crs::is_projected() const { return facts().projected; }
bool Crs::is_geocentric() const { return facts().geocentric; }
bool Crs::has_vertical() const { return facts().vertical; }
Heights Crs::heights() const { return facts().heights; }
bool Crs::has_height_unit() const { return has_vertical() || heights() == Heights::ellipsoidal; }
Crs Crs::horizontal() const { return Crs(facts().horizontal_wkt); }
std::string Crs::vertical_name() const { return facts().vertical_name; }
double Crs::metres_per_unit() const { return facts().horizontal_axis.factor; }
double Crs::vertical_metres_per_unit() const { return facts().vertical_axis.factor; }
std::string Crs::unit_name() const { return facts().horizontal_axis.unit; }
std::string Crs::vertical_unit_name() const { return facts().vertical_axis.unit; }

bool Crs::area_of_use(double& west, double& south, double& east, double& north) const {
  const CrsFacts& s = facts();
  if (!s.has_area) return false;
  west = s.area[0], south = s.area[1], east = s.area[2], north = s.area[3];
  return true;
}

Crs wgs84_ecef() {
  static const Crs crs("EPSG:4978");
  return crs;
}
Crs wgs84_geodetic() {
  static const Crs crs("EPSG:4979");
  return crs;
}

}  // namespace swath::core
