// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/measures/level_curve.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/error.h"

namespace swath::pipeline {
namespace {

constexpr size_t max_levels = 1000;

[[noreturn]] void refuse(const std::string& text, const std::string& why) {
  throw core::usage_error("'" + text + "': " + why, "--levels", "write lowest, highest and step in the unit of the heights: 405,420,0.5");
}

}  // namespace

std::vector<double> levels_of(const std::string& text) {
  std::vector<double> v;
  const char* at = text.c_str();
  for (;;) {
    char* end = nullptr;
    v.push_back(std::strtod(at, &end));
    if (end == at || !std::isfinite(v.back())) refuse(text, "not three numbers");
    at = end;
    if (*at != ',') break;
    ++at;
  }
  if (v.size() != 3 || *at != '\0') refuse(text, "not three numbers");
  const double low = v[0], high = v[1], step = v[2];
  if (!(step > 0.0)) refuse(text, "the step is not above 0");
  if (!(high > low)) refuse(text, "the highest level is not above the lowest");
  const double count = std::floor((high - low) / step + 1e-9);
  if (count + 2.0 > static_cast<double>(max_levels)) refuse(text, "more than 1000 levels");
  std::vector<double> out;
  for (double k = 0.0; k <= count; ++k) out.push_back(low + k * step);
  if (high - out.back() > 1e-9 * step) out.push_back(high);
  return out;
}

LevelCurve level_curve(const VolumeRequest& request, const std::vector<double>& levels) {
  LevelCurve out;
  for (const double level : levels) {
    VolumeRequest one = request;
    one.design = level;
    out.last = volumes_of(one);
    const report::Volumes& v = out.last.volumes;
    out.rows.push_back({level, v.fill_area, v.fill, v.sigma_fill});
  }
  return out;
}

std::string level_text(const LevelCurve& curve) {
  char line[200];
  const bool metres = curve.last.has_crs;
  std::snprintf(line, sizeof line, "%12s %16s %18s %14s\n", "level", metres ? "area, m2" : "area", metres ? "volume, m3" : "volume",
                "sigma");
  std::string out = line;
  for (const LevelRow& r : curve.rows) {
    std::snprintf(line, sizeof line, "%12.3f %16.2f %18.2f", r.level, r.area, r.volume);
    out += line;
    if (std::isfinite(r.sigma)) std::snprintf(line, sizeof line, " %14.2f", r.sigma), out += line;
    out += "\n";
  }
  if (curve.last.volumes.left_out > 0) {
    std::snprintf(line, sizeof line, "left out: %.2f%s where the terrain is void\n", curve.last.volumes.area_left_out, metres ? " m2" : "");
    out += line;
  }
  return out + note_text(curve.last);
}

}  // namespace swath::pipeline
