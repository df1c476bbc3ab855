// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/map_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "core/error.h"
#include "core/geo/map_scale.h"

namespace swath::pipeline {
namespace {

/// Map coordinates, units of the CRS.
std::vector<Eigen::Vector2d> places_of(const stages::Context& context) {
  std::vector<Eigen::Vector2d> out;
  const stages::Box& box = context.area.box;
  constexpr double none = stages::Area::none;
  const bool has_box = box.x0 > -none && box.y0 > -none && box.x1 < none && box.y1 < none;
  if (!context.origin.isZero()) out.emplace_back(context.origin.head<2>() / context.unit);
  if (has_box) out.emplace_back(Eigen::Vector2d(0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1)) / context.unit);
  return out;
}

/// "2.8 % longer", "3.1 % shorter", "1.49 times those on the ground".
std::string compared(double scale) {
  char text[64];
  if (scale > 1.5 || scale < 0.67)
    std::snprintf(text, sizeof text, "%.2f times those on the ground", scale);
  else
    std::snprintf(text, sizeof text, "%.3g %% %s than on the ground", 100.0 * std::abs(scale - 1.0), scale > 1.0 ? "longer" : "shorter");
  return text;
}

}  // namespace

std::optional<MapFit> map_fit(const stages::Context& context) {
  if (context.crs.empty() || !context.crs.is_projected()) return std::nullopt;
  std::optional<MapFit> best;
  for (const Eigen::Vector2d& at : places_of(context)) {
    const auto place = core::place_on_earth(context.crs, at);
    const auto scale = core::map_scale(context.crs, at);
    if (!place || !scale) continue;
    const double k = scale->worst(), outside = core::degrees_outside(context.crs, *place);
    const double nearest = best ? std::min(best->outside, outside) : outside;
    if (!best || std::abs(best->scale - 1.0) > std::abs(k - 1.0))
      best = MapFit{k, scale->area(), outside, core::utm_zone(*place, context.crs)};
    best->outside = nearest;
  }
  return best;
}

void require_map_fit(const stages::Context& context, const std::string& where, bool from_command_line) {
  const auto fit = map_fit(context);
  if (!fit || std::abs(fit->scale - 1.0) <= refused_scale) return;
  char area[32];
  std::snprintf(area, sizeof area, "%.2f", fit->area);
  throw core::usage_error("the map projection is not for this place: in " + context.crs.name() + " lengths are " + compared(fit->scale) +
                              ", areas " + area + " times as large; cells, densities, slopes and volumes would be wrong",
                          where,
                          std::string("name a local projection as CRS of the products, for example the UTM zone: ") +
                              (from_command_line ? "--crs " + fit->zone : "crs = \"" + fit->zone + "\" in the survey") +
                              "; clouds in other CRSs are transformed");
}

std::string scale_warning(const std::string& crs, double scale) {
  return "in " + crs + " lengths at the data are " + compared(scale) + ": areas, densities, slopes and volumes are those of the map";
}

std::string outside_warning(const std::string& crs, double degrees) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", degrees);
  return std::string("the data lie ") + text + " degrees outside the area of use of " + crs;
}

}  // namespace swath::pipeline
