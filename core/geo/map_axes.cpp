// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/map_axes.h"

#include "core/error.h"
#include "core/geo/map_scale.h"
#include "core/geo/proj_handles.h"

namespace swath::core {
namespace {

/// The map projection without heights and without a shift of its own; null for what is none.
Pj projection_of(PJ_CONTEXT* c, const Crs& crs) {
  if (crs.empty() || !crs.is_projected()) return nullptr;
  Pj map = parse_crs(c, crs.facts().horizontal_wkt);
  while (map && proj_get_type(map.get()) == PJ_TYPE_BOUND_CRS) map = Pj(proj_get_source_crs(c, map.get()));
  return map;
}

std::string direction_of(PJ_CONTEXT* c, const PJ* crs, int axis) {
  const char* direction = nullptr;
  const Pj axes(proj_crs_get_coordinate_system(c, crs));
  if (!axes || !proj_cs_get_axis_info(c, axes.get(), axis, nullptr, nullptr, &direction, nullptr, nullptr, nullptr, nullptr)) return {};
  return proj_text(direction);
}

std::string heights_part(const Crs& crs) {
  if (crs.heights() == Heights::ellipsoidal) return "+ellipsoidal";
  return crs.vertical_epsg() != 0 ? "+" + std::to_string(crs.vertical_epsg()) : "";
}

/// The middle of the area of use of a map; that of a geographic CRS may be the whole globe.
std::optional<Place> middle_of(const Crs& map) {
  double west = 0, south = 0, east = 0, north = 0;
  if (map.empty() || !map.is_projected()) return std::nullopt;
  // WKT1 holds a code and no area.
  if (!map.area_of_use(west, south, east, north) &&
      (map.epsg() == 0 || !Crs("EPSG:" + std::to_string(map.epsg())).area_of_use(west, south, east, north)))
    return std::nullopt;
  return Place{0.5 * (west + (east < west ? east + 360.0 : east)), 0.5 * (south + north)};
}

}  // namespace

std::string utm_for(const Crs& crs, const std::optional<Eigen::Vector2d>& at) {
  std::optional<Place> place;
  if (at) place = crs.is_geographic() ? Place{at->x(), at->y()} : place_on_earth(crs, *at);
  if (!place) place = middle_of(crs);
  return place ? utm_zone(*place, crs) + heights_part(crs) : "EPSG:326xx (north) or EPSG:327xx (south)";
}

std::string turned_axes(const Crs& crs) {
  const ProjContext context = new_proj_context();
  const Pj map = projection_of(context.get(), crs);
  if (!map) return {};
  const std::string x = direction_of(context.get(), map.get(), 0), y = direction_of(context.get(), map.get(), 1);
  const bool is_turned_round = x == "north" && y == "east";
  if (x == y || is_turned_round || (x == "east" && y == "north")) return {};
  return x + "ing and " + y + "ing";
}

std::string easting_northing_form(const Crs& crs) {
  const ProjContext context = new_proj_context();
  PJ_CONTEXT* c = context.get();
  const Pj map = projection_of(c, crs);
  if (!map) return {};
  // EPSG's own name of these: "S-JTSK / Krovak East North" beside "S-JTSK / Krovak".
  const std::string name = proj_text(proj_get_name(map.get())) + " East North";
  const PJ_TYPE kind = PJ_TYPE_PROJECTED_CRS;
  const PjList found(proj_create_from_name(c, "EPSG", name.c_str(), &kind, 1, 0, 1, nullptr));
  const Pj form(found && proj_list_get_count(found.get()) > 0 ? proj_list_get(c, found.get(), 0) : nullptr);
  if (!form || proj_text(proj_get_name(form.get())) != name) return {};
  return "EPSG:" + proj_text(proj_get_id_code(form.get(), 0)) + heights_part(crs);
}

void require_easting_northing(const Crs& crs, const std::string& where) {
  const std::string turned = turned_axes(crs);
  if (turned.empty()) return;
  const std::string form = easting_northing_form(crs);
  throw usage_error("the map's axes are " + turned + " in " + crs.name() + ": a map with easting and northing is needed", where,
                    form.empty() ? "use such a CRS, for example the UTM zone " + utm_for(crs) + "; transform coordinates that exist"
                                 : "use " + form + ", the same projection with easting and northing; transform coordinates that exist");
}

}  // namespace swath::core
