// SPDX-License-Identifier: GPL-3.0-or-later
// Source: ASPRS LAS 1.4 R15, section 3; OGC 19-008r4 (GeoTIFF 1.1) for the keys.
// Deviation: user-defined systems of GeoTIFF keys (ellipsoid and projection parameters one by one) are not built; the note says so.
#include "io/las_crs.h"

#include <algorithm>
#include <limits>

#include "io/las_bytes.h"

namespace swath::io {

using las::get;

LasCrs las_crs(const LasHeader& h) {
  LasCrs out;
  const LasVlr *wkt = nullptr, *keys = nullptr;
  for (const auto* list : {&h.vlrs, &h.evlrs})
    for (const LasVlr& v : *list) {
      if (v.user_id == "LASF_Projection" && v.record_id == 2112) wkt = &v;
      if (v.user_id == "LASF_Projection" && v.record_id == 34735) keys = &v;
    }
  if (wkt) {
    out.definition = std::string(wkt->data.begin(), std::find(wkt->data.begin(), wkt->data.end(), std::uint8_t{0}));
    if (!out.definition.empty()) return out;
    out.note = "the WKT record is empty";
  }
  if (!keys || keys->data.size() < 8) return out;
  int model = 0, horizontal = 0, vertical = 0;
  const std::size_t count = std::min<std::size_t>(get<std::uint16_t>(&keys->data[6]), keys->data.size() / 8 - 1);
  for (std::size_t i = 1; i <= count; ++i) {
    const std::uint8_t* key = &keys->data[8 * i];
    const int id = get<std::uint16_t>(key), place = get<std::uint16_t>(key + 2), value = get<std::uint16_t>(key + 6);
    if (place != 0) continue;
    if (id == 1024) model = value;
    if (id == 3072 || (id == 2048 && horizontal == 0)) horizontal = value;  // ProjectedCSType goes before GeographicType
    if (id == 4096) vertical = value;
    if (id == 4099) out.vertical_metres = value == 9001 ? 1.0 : value == 9002 ? 0.3048 : value == 9003 ? 1200.0 / 3937.0 : 0.0;
  }
  if (model == 3) {  // geocentric: the keys name the datum alone
    if (horizontal == 4326 || horizontal == 4978)
      out.definition = "EPSG:4978";
    else
      out.note = "the geocentric system of the GeoTIFF keys is on a datum other than WGS84";
    return out;
  }
  const auto is_code = [](int v) { return v > 1023 && v < 32767; };
  if (!is_code(horizontal)) {
    out.note =
        horizontal == 0 ? "the GeoTIFF keys name no coordinate system" : "the GeoTIFF keys define a coordinate system without EPSG code";
    return out;
  }
  out.definition = "EPSG:" + std::to_string(horizontal);
  // GeoTIFF 1.0 numbers ellipsoidal heights 5001 to 5033: those are no EPSG vertical systems.
  if (is_code(vertical) && (vertical < 5001 || vertical > 5033))
    out.definition += "+" + std::to_string(vertical);
  else if (vertical != 0)
    out.note = "the vertical system " + std::to_string(vertical) + " of the GeoTIFF keys has no EPSG code";
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
