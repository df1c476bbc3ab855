// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/short_waves.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace swath::calib {
namespace {

constexpr size_t fewest = 6;           // groups in a stretch that is looked at
constexpr double least_chance = 4.0;   // sigmas
constexpr double least_matters = 1.5;  // times the variance

}  // namespace

bool ShortWaves::seen() const {
  if (stretches == 0) return false;
  const double limit = std::max(least_matters, 1.0 + least_chance * std::sqrt(2.0 / stretches));
  return std::max(shift, turn) > limit;
}

ShortWaves short_waves(const std::vector<GroupResidual>& groups, double within) {
  std::map<std::uint32_t, double> first;  // by line
  const auto counts = [](const GroupResidual& g) { return !g.rejected && g.returns > 0 && g.redundancy > 0.0 && std::isfinite(g.w); };
  for (const GroupResidual& g : groups) {
    if (!counts(g)) continue;
    const auto [at, made] = first.try_emplace(g.line, g.time);
    if (!made) at->second = std::min(at->second, g.time);
  }
  std::map<std::pair<std::uint32_t, std::int64_t>, std::vector<const GroupResidual*>> stretches;
  for (const GroupResidual& g : groups)
    if (counts(g)) stretches[{g.line, static_cast<std::int64_t>(std::floor((g.time - first[g.line]) / within))}].push_back(&g);
  ShortWaves out;
  double shift = 0.0, turn = 0.0;
  for (const auto& [key, in] : stretches) {
    if (in.size() < fewest) continue;
    const auto n = static_cast<double>(in.size());
    double w = 0.0, side = 0.0;
    for (const GroupResidual* g : in) w += g->w / n, side += std::sin(g->angle) / n;
    double product = 0.0, squares = 0.0;
    for (const GroupResidual* g : in) {
      const double s = std::sin(g->angle) - side;
      product += s * g->w, squares += s * s;
    }
    if (squares <= 0.0) continue;
    shift += n * w * w;
    turn += product * product / squares;
    ++out.stretches;
  }
  if (out.stretches == 0) return out;
  out.shift = shift / out.stretches;
  out.turn = turn / out.stretches;
  return out;
}

}  // namespace swath::calib
