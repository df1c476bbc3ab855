// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/map_class.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include "core/error.h"

namespace swath::terrain {
namespace {
constexpr double rounding = 1e-9;  // relative, so that 3 * 0.1 carries 0.3
}

char map_class_of(double interval, double sigma) {
  for (const MapClass& c : map_classes)
    if (sigma <= c.standard_error * interval * (1.0 + rounding)) return c.name;
  return '-';
}

double smallest_interval(const MapClass& c, double sigma) { return sigma / c.standard_error; }

double usual_interval(double interval) {
  if (!(interval > 0.0)) return 0.0;
  const double decade = std::pow(10.0, std::floor(std::log10(interval)));
  for (const double step : {1.0, 2.0, 2.5, 5.0})
    if (step * decade >= interval * (1.0 - rounding)) return step * decade;
  return 10.0 * decade;
}

SurfaceFacts& SurfaceFacts::operator+=(const SurfaceFacts& o) {
  sum_of_heights += o.sum_of_heights;
  sum_of_variances += o.sum_of_variances;
  heights += o.heights;
  sigmas += o.sigmas;
  beyond += o.beyond;
  lowest = std::min(lowest, o.lowest);
  highest = std::max(highest, o.highest);
  return *this;
}

SurfaceFacts facts_of(const core::Grid& grid, const core::Lattice& own, double interval) {
  SurfaceFacts f;
  const core::Lattice& l = grid.lattice;
  for (int j = 0; j < own.ny; ++j)
    for (int i = 0; i < own.nx; ++i) {
      const size_t at = l.at(static_cast<int>(own.i0 - l.i0) + i, static_cast<int>(own.j0 - l.j0) + j);
      if (std::isnan(grid.height[at])) continue;
      f.sum_of_heights += grid.height[at];
      ++f.heights;
      f.lowest = std::min<double>(f.lowest, grid.height[at]);
      f.highest = std::max<double>(f.highest, grid.height[at]);
      if (grid.sigma.empty() || std::isnan(grid.sigma[at])) continue;
      const double sigma = grid.sigma[at];
      f.sum_of_variances += sigma * sigma;
      ++f.sigmas;
      f.beyond += map_class_of(interval, sigma) == '-';
    }
  return f;
}

std::string written_out(double length) {
  std::array<char, 400> text{};  // of the smallest number, too
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), std::stod(core::format_number(length, 4)), std::chars_format::fixed);
  return {text.data(), end.ptr};
}

std::string too_many_levels(const SurfaceFacts& f, double interval, double unit) {
  const double levels = std::floor((f.highest - f.lowest) / interval);
  if (!(levels > max_levels)) return {};
  const std::string name = unit == 1.0 ? " m" : " ft";
  const auto height = [&](double h) { return core::format_number(std::round(h / unit * 10) / 10); };
  return "contours every " + written_out(interval / unit) + name + " between heights of " + height(f.lowest) + " and " + height(f.highest) +
         name + " are " + core::format_number(levels) + " levels, and at most " + core::format_number(max_levels) + " are drawn";
}

double least_interval(const SurfaceFacts& f, double unit) { return unit * usual_interval((f.highest - f.lowest) / max_levels / unit); }

CarriedInterval judge_interval(const SurfaceFacts& f, double interval, double flying_height, double unit) {
  CarriedInterval out;
  if (const double above = flying_height - f.sum_of_heights / static_cast<double>(f.heights); std::isfinite(above))
    out.c_factor = above / interval;
  if (f.sigmas == 0) {
    out.findings.push_back("the model has no sigma, so nothing says which interval it carries");
    return out;
  }
  const double sigma = std::sqrt(f.sum_of_variances / static_cast<double>(f.sigmas));
  const char kept = map_class_of(interval, sigma);
  out.model_sigma = sigma;
  out.map_class = kept == '-' ? std::string("none") : std::string(1, kept);
  out.smallest.emplace();
  for (size_t k = 0; k < map_classes.size(); ++k) out.smallest->of[k] = smallest_interval(map_classes[k], sigma);
  out.beyond_class_c = static_cast<double>(f.beyond) / static_cast<double>(f.sigmas);
  if (kept != '-') return out;
  const std::string name = unit == 1.0 ? " m" : " ft";
  const auto carried = [&](size_t k) { return core::format_number(usual_interval(out.smallest->of[k] / unit)) + name; };
  out.findings.push_back("contours every " + core::format_number(interval / unit, 4) + name +
                         " say more than the model knows: its sigma of " + core::format_number(std::round(sigma / unit * 1e3) / 1e3) +
                         name + " (rms) carries " + carried(0) + " as class A, " + carried(1) + " as class B, " + carried(2) +
                         " as class C");
  return out;
}

}  // namespace swath::terrain
