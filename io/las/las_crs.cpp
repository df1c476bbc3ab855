// SPDX-License-Identifier: GPL-3.0-or-later
// Source: ASPRS LAS 1.4 R15, section 3; OGC 19-008r4 (GeoTIFF 1.1) for the keys.
// Systems that the keys define parameter by parameter are built by GDAL, from a TIFF in memory with the same keys.
#include "io/las/las_crs.h"

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/crs.h"
#include "io/las/las_bytes.h"
#include "io/vector/gdal_door.h"

namespace swath::io {

using las::get;

namespace {

const LasVlr* record(const LasHeader& h, int id, bool may_be_empty = true) {
  const LasVlr* found = nullptr;
  for (const auto* list : {&h.vlrs, &h.evlrs})
    for (const LasVlr& v : *list)
      if (v.user_id == "LASF_Projection" && v.record_id == id && (may_be_empty || !v.data.empty())) found = &v;
  return found;
}

/// The text up to its end, without blanks around it.
std::string text_of(const LasVlr& v) {
  std::string text(v.data.begin(), std::find(v.data.begin(), v.data.end(), std::uint8_t{0}));
  constexpr const char* blanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(blanks);
  return first == std::string::npos ? std::string() : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Why core::Crs does not take a definition; empty where it does.
std::string fault_of(const std::string& definition) {
  try {
    core::Crs{definition};
    return {};
  } catch (const core::Error& e) {
    return e.what();
  }
}

struct Keys {
  int model = 0, projected = 0, geographic = 0, linear_unit = 0, vertical = 0, vertical_datum = 0, vertical_unit = 0;
  int horizontal() const { return projected != 0 ? projected : geographic; }  // ProjectedCSType goes before GeographicType
};

Keys keys_of(const LasVlr& v) {
  Keys k;
  const std::size_t count = std::min<std::size_t>(get<std::uint16_t>(&v.data[6]), v.data.size() / 8 - 1);
  for (std::size_t i = 1; i <= count; ++i) {
    const std::uint8_t* key = &v.data[8 * i];
    const int id = get<std::uint16_t>(key), place = get<std::uint16_t>(key + 2), value = get<std::uint16_t>(key + 6);
    if (place != 0) continue;
    if (id == 1024) k.model = value;
    if (id == 3072) k.projected = value;
    if (id == 3076) k.linear_unit = value;
    if (id == 2048) k.geographic = value;
    if (id == 4096) k.vertical = value;
    if (id == 4098) k.vertical_datum = value;
    if (id == 4099) k.vertical_unit = value;
  }
  return k;
}

bool is_code(int v) { return v > 1023 && v < 32767; }
/// GeoTIFF 1.0 (6.3.4.1): ellipsoidal heights, by the ellipsoid's number.
bool is_ellipsoid(int v) { return v >= 5001 && v <= 5033; }

/// GeoTIFF 1.0 numbers vertical systems by their datum (6.3.4.1): EPSG's system of that datum, with heights in `unit`.
int vertical_system(int code, int unit) {
  constexpr int metre = 9001, foot = 9002, survey_foot = 9003;
  if (code == 5104) return 5736;                                  // Yellow Sea 1956
  if (code == 5101 || code == 5105 || code == 5106) code += 600;  // Newlyn, Baltic Sea, Caspian Sea
  if (code == 5102) code = unit == metre ? 7968 : 5702;           // NGVD29
  if (code == 5103) code = 5703;                                  // NAVD88
  if (code == 5703 && unit == foot) return 8228;
  if (code == 5703 && unit == survey_foot) return 6360;
  return code;
}

double metres_of(int unit) { return unit == 9001 ? 1.0 : unit == 9002 ? 0.3048 : unit == 9003 ? 1200.0 / 3937.0 : 0.0; }

/// A TIFF of one pixel with the file's GeoTIFF tags: GDAL reads from it what the keys define one by one.
std::vector<std::uint8_t> tiff_of(const LasHeader& h, const LasVlr& keys) {
  struct Entry {
    std::uint16_t tag, type;
    std::uint32_t count;
    std::vector<std::uint8_t> data;
  };
  std::vector<std::uint8_t> out;
  const auto put = [](std::vector<std::uint8_t>& to, std::uint32_t v, int bytes) {
    for (int k = 0; k < bytes; ++k) to.push_back(static_cast<std::uint8_t>(v >> (8 * k)));
  };
  std::vector<Entry> entries;
  const auto add = [&](std::uint16_t tag, std::uint32_t v) {
    entries.push_back({tag, 4, 1, {}});
    put(entries.back().data, v, 4);
  };
  add(256, 1), add(257, 1), add(258, 8), add(259, 1), add(262, 1), add(273, 8), add(277, 1), add(278, 1), add(279, 1);
  const std::size_t count = std::min<std::size_t>(get<std::uint16_t>(&keys.data[6]), keys.data.size() / 8 - 1);
  std::vector<std::uint8_t> directory(keys.data.begin(), keys.data.begin() + static_cast<std::ptrdiff_t>(8 * (count + 1)));
  directory[6] = static_cast<std::uint8_t>(count), directory[7] = static_cast<std::uint8_t>(count >> 8);
  entries.push_back({34735, 3, static_cast<std::uint32_t>(directory.size() / 2), std::move(directory)});
  if (const LasVlr* v = record(h, 34736, false))
    entries.push_back({34736, 12, static_cast<std::uint32_t>(v->data.size() / 8), {v->data.begin(), v->data.end()}});
  if (const LasVlr* v = record(h, 34737, false)) {
    entries.push_back({34737, 2, static_cast<std::uint32_t>(v->data.size() + 1), {v->data.begin(), v->data.end()}});
    entries.back().data.push_back(0);
  }
  constexpr std::uint32_t pixel_end = 10;  // the pixel lies behind the head, at byte 8
  out = {'I', 'I', 42, 0};
  put(out, pixel_end, 4);
  put(out, 0, 2);
  put(out, static_cast<std::uint32_t>(entries.size()), 2);
  const std::size_t tail_at = pixel_end + 2 + 12 * entries.size() + 4;
  std::vector<std::uint8_t> tail;
  for (const Entry& e : entries) {
    put(out, e.tag, 2), put(out, e.type, 2), put(out, e.count, 4);
    if (e.data.size() <= 4) {
      std::vector<std::uint8_t> four = e.data;
      four.resize(4);
      out.insert(out.end(), four.begin(), four.end());
    } else {
      put(out, static_cast<std::uint32_t>(tail_at + tail.size()), 4);
      tail.insert(tail.end(), e.data.begin(), e.data.end());
      if (tail.size() % 2) tail.push_back(0);
    }
  }
  put(out, 0, 4);
  out.insert(out.end(), tail.begin(), tail.end());
  return out;
}

/// What GDAL makes of keys that define a system parameter by parameter; empty where that is nothing.
std::string defined_by(const LasHeader& h, const LasVlr& keys, bool and_heights = true) {
  static std::atomic<unsigned> number{0};
  std::vector<std::uint8_t> bytes = tiff_of(h, keys);
  const std::string name = "/vsimem/swath_las_crs_" + std::to_string(number++) + ".tif";
  const GdalMessages messages;
  const GdalSetting with_vertical("GTIFF_REPORT_COMPD_CS", and_heights ? "YES" : "NO");
  VSIFCloseL(VSIFileFromMemBuffer(name.c_str(), bytes.data(), bytes.size(), FALSE));
  std::string out;
  if (GDALDataset* set = GDALDataset::Open(name.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY)) {
    const char* const options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
    char* text = nullptr;
    if (const OGRSpatialReference* srs = set->GetSpatialRef(); srs && !srs->IsLocal() && srs->exportToWkt(&text, options) == OGRERR_NONE)
      out = text;
    CPLFree(text);
    GDALClose(set);
  }
  VSIUnlink(name.c_str());
  return fault_of(out).empty() ? out : std::string();
}

void add_vertical(const Keys& k, LasCrs& out) {
  int vertical = k.vertical == 32767 || k.vertical == 0 ? k.vertical_datum : k.vertical;
  if (vertical == 0 || vertical == 32767) return;
  if (is_ellipsoid(vertical)) {
    out.definition += "+ellipsoidal";
    return;
  }
  vertical = vertical_system(vertical, k.vertical_unit);
  const std::string whole = out.definition + "+" + std::to_string(vertical);
  if (!is_code(vertical) || !fault_of(whole).empty()) {
    out.note = "the vertical system " + std::to_string(vertical) + " of the GeoTIFF keys is not known";
    return;
  }
  const double unit = core::Crs(whole).vertical_metres_per_unit();
  if (out.vertical_metres > 0.0 && std::abs(unit - out.vertical_metres) > 1e-9) {
    out.note = "the GeoTIFF keys state a height unit of " + core::format_number(out.vertical_metres) + " m beside the vertical system " +
               std::to_string(vertical) + ", which counts in " + core::format_number(unit) + " m: the system is not used";
    return;
  }
  out.definition = whole;
}

bool is_same_unit(double a, double b) { return std::abs(a / b - 1.0) < 1e-9; }

/// ProjLinearUnitsGeoKey beside a code whose axes count in another unit, as LAStools writes UTM in feet: the key counts, as in GDAL.
void set_linear_unit(const LasHeader& h, const LasVlr& keys, int unit, LasCrs& out) {
  const double metres = metres_of(unit);
  const core::Crs coded = fault_of(out.definition).empty() ? core::Crs(out.definition) : core::Crs();
  if (metres == 0.0 || coded.empty() || !coded.is_projected() || is_same_unit(coded.metres_per_unit(), metres)) return;
  const std::string map = defined_by(h, keys, false);
  if (map.empty() || !is_same_unit(core::Crs(map).metres_per_unit(), metres)) {
    out.note = "the GeoTIFF keys state a unit of " + core::format_number(metres, 9) + " m beside " + coded.name() + ", which counts in " +
               core::format_number(coded.metres_per_unit(), 9) + " m";
    out.definition.clear();
    return;
  }
  const std::string whole = coded.wkt1();
  if (coded.heights() == core::Heights::ellipsoidal)
    out.definition = map + "+ellipsoidal";
  else if (const std::size_t heights = whole.find(",VERT_CS["); heights != std::string::npos)
    out.definition = "COMPD_CS[\"" + coded.name() + "\"," + core::Crs(map).wkt1() + whole.substr(heights);
  else
    out.definition = map;
}

void read_keys(const LasHeader& h, const LasVlr& keys, LasCrs& out) {
  const Keys k = keys_of(keys);
  out.vertical_metres = metres_of(k.vertical_unit);
  if (k.model == 3) {  // geocentric: the keys name the datum alone
    if (k.horizontal() == 4326 || k.horizontal() == 4978)
      out.definition = "EPSG:4978";
    else
      out.note = "the geocentric system of the GeoTIFF keys is on a datum other than WGS84";
    return;
  }
  if (is_code(k.horizontal())) {
    out.definition = "EPSG:" + std::to_string(k.horizontal());
    add_vertical(k, out);
    return set_linear_unit(h, keys, k.linear_unit, out);
  }
  if (k.horizontal() != 0) out.definition = defined_by(h, keys);
  if (out.definition.empty())
    out.note = k.horizontal() == 0 ? "the GeoTIFF keys name no coordinate system"
                                   : "the GeoTIFF keys define a coordinate system that is not understood";
}

}  // namespace

LasCrs las_crs(const LasHeader& h) {
  LasCrs out;
  const LasVlr *wkt = record(h, 2112), *keys = record(h, 34735);
  std::string wkt_note;
  if (wkt) {
    out.definition = text_of(*wkt);
    const std::string fault = out.definition.empty() ? std::string() : fault_of(out.definition);
    if (!out.definition.empty() && fault.empty()) return out;
    wkt_note = out.definition.empty() ? "the WKT record is empty" : "the WKT record is not understood: " + fault;
    out.definition.clear();
  }
  if (keys && keys->data.size() >= 8) read_keys(h, *keys, out);
  if (!wkt_note.empty())
    out.note = wkt_note + (out.definition.empty() ? "" : "; the GeoTIFF keys are used") + (out.note.empty() ? "" : "; " + out.note);
  return out;
}

void add_las_wkt(LasHeader& header, const std::string& wkt) {
  if (wkt.empty()) return;
  LasVlr v{"LASF_Projection", 2112, "OGC coordinate system WKT", {wkt.begin(), wkt.end()}, 0, 0};
  v.data.push_back(0);
  header.global_encoding |= las_encoding::wkt;
  (v.data.size() > std::numeric_limits<std::uint16_t>::max() ? header.evlrs : header.vlrs).push_back(std::move(v));
}

}  // namespace swath::io
