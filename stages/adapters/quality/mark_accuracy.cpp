// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/quality/mark_accuracy.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/distributions.h"
#include "quality/cover_words.h"

namespace swath::stages {
namespace {

constexpr std::uint64_t enough_marks = 30;  // ASPRS 2024: fewer make no statement of accuracy

struct MarkErrors {
  std::vector<double> error, mark_sigma, sigma;
};

CoverAccuracy accuracy_of_group(const std::string& product, const std::string& cover, const MarkErrors& g) {
  CoverAccuracy a{product, cover, report::statistics(g.error)};
  const auto n = static_cast<double>(g.error.size());
  std::vector<double> sizes;
  double squares = 0.0, predicted = 0.0;
  bool has_sigmas = true;
  for (size_t k = 0; k < g.error.size(); ++k) {
    sizes.push_back(std::abs(g.error[k]));
    squares += g.mark_sigma[k] * g.mark_sigma[k];
    predicted += g.mark_sigma[k] * g.mark_sigma[k] + g.sigma[k] * g.sigma[k];
    has_sigmas = has_sigmas && g.sigma[k] > 0.0;
  }
  a.q90 = core::interpolated_quantile(sizes, 0.9);
  a.marks_sigma = std::sqrt(squares / n);
  a.with_marks = std::hypot(a.errors.rms, a.marks_sigma);
  const double rest = a.errors.rms * a.errors.rms - a.marks_sigma * a.marks_sigma;
  a.without_marks = std::copysign(std::sqrt(std::abs(rest)), rest);
  a.bias_share = std::abs(a.errors.mean) / a.errors.rms;
  a.predicted = has_sigmas ? std::sqrt(predicted / n) : std::nan("");
  a.error_over_sigma = a.errors.rms / a.predicted;
  a.is_enough = a.errors.n >= enough_marks;
  return a;
}

std::string class_text(const std::string& name) { return name.empty() ? "none" : name; }

}  // namespace

std::vector<CoverAccuracy> accuracy_of(const std::vector<quality::CheckMark>& marks, const std::vector<MarkFound>& found,
                                       const std::vector<std::string>& open) {
  std::vector<CoverAccuracy> out;
  for (const auto& [product, difference] : {std::pair("points", &MarkFound::points), std::pair("dtm", &MarkFound::dtm)}) {
    std::map<std::string, MarkErrors> groups;
    for (size_t m = 0; m < marks.size(); ++m) {
      const double error = found[m].*difference;
      if (std::isnan(error)) continue;
      const std::string& cover = marks[m].cover;
      std::vector<std::string> kinds{quality::is_open_cover(cover, open) ? open_cover : vegetated_cover, every_cover};
      if (!cover.empty()) kinds.push_back(cover);
      for (const std::string& kind : kinds) {
        MarkErrors& g = groups[kind];
        g.error.push_back(error);
        g.mark_sigma.push_back(marks[m].sigma);
        g.sigma.push_back(found[m].sigma);
      }
    }
    for (const auto& [kind, group] : groups) out.push_back(accuracy_of_group(product, kind, group));
  }
  return out;
}

const CoverAccuracy* judged_accuracy(const std::vector<CoverAccuracy>& list, const std::string& product, const std::string& cover) {
  const auto at = std::find_if(list.begin(), list.end(), [&](const auto& a) {
    return a.product == product && a.cover == cover && a.errors.n >= fewest_marks_judged;
  });
  return at == list.end() ? nullptr : &*at;
}

std::optional<MapClassFound> map_class_of(const MapOptions& o, const CoverAccuracy* heights, std::optional<double> roofs, double sigma_h) {
  if (!o.scale && !o.interval) return std::nullopt;
  MapClassFound out;
  out.rule = core::Choices<quality::MapRule>::names[static_cast<size_t>(o.rule)];
  if (heights) {
    out.ep_height = heights->errors.rms;
    out.q90_height = heights->q90;
    if (o.interval) out.height_class = class_text(quality::height_class(o.rule, o.interval->value, *out.ep_height, out.q90_height));
    for (const quality::MapClass& c : quality::map_classes(o.rule))
      out.intervals.push_back({c.name, quality::closest_interval(o.rule, c.name, *out.ep_height, out.q90_height)});
    if (o.flying_height) out.c_factor = quality::c_factor_of(o.flying_height->value, out.intervals[0].interval);
  }
  if (o.flying_height && o.c_factor) out.interval_by_c = quality::interval_of(o.flying_height->value, *o.c_factor);
  if (o.planimetry)
    out.ep_plan = o.planimetry->value, out.plan_from = "measured, as stated";
  else if (roofs)
    out.ep_plan = *roofs, out.plan_from = "measured: radial RMSE of roofs";
  else if (sigma_h > 0.0)
    out.ep_plan = sigma_h, out.plan_from = "predicted: sigma_h of the points around the check points";
  if (o.scale && out.ep_plan) out.plan_class = class_text(quality::plan_class(o.rule, *o.scale, *out.ep_plan));
  if (out.plan_class && out.height_class) {
    const auto plain = [](const std::string& name) { return name == "none" ? std::string() : name; };
    out.both = class_text(quality::both_classes(plain(*out.plan_class), plain(*out.height_class)));
  }
  return out;
}

}  // namespace swath::stages
