// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/terrain/powerline_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/config/units.h"
#include "stages/adapters/terrain/on_map.h"

namespace swath::stages {
namespace {

constexpr double vertex_step = 2.0;     // m along a conductor
constexpr size_t drawn_returns = 6000;  // of each kind on a sheet
constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Places in the run's CRS.
std::vector<Eigen::Vector3d> vertices(const terrain::Conductor& c) {
  std::vector<Eigen::Vector3d> out;
  const int pieces = std::max(1, static_cast<int>(std::ceil((c.last.s - c.first.s) / vertex_step)));
  for (int k = 0; k <= pieces; ++k) out.push_back(c.strand.at(c.first.s + (c.last.s - c.first.s) * k / pieces));
  return out;
}

std::vector<Eigen::Vector3d> mapped(std::vector<Eigen::Vector3d> places, const OnMap& map) {
  for (Eigen::Vector3d& p : places) p = map(p);
  return places;
}

io::FieldValue whole(size_t n) { return static_cast<std::int64_t>(n); }
io::FieldValue pylon_number(const std::optional<size_t>& p) { return p ? std::to_string(*p + 1) : std::string(); }

io::SpatialLayer conductors(const PowerLineResult& r, const OnMap& map) {
  io::SpatialLayer out{"conductors",
                       "Wires as catenaries z = z0 + a cosh((s - s0) / a) - a, s m from the first vertex; lengths and sigmas in m",
                       io::SpatialShape::line,
                       false,
                       {{"name", std::string()},
                        {"span", std::int64_t{}},
                        {"wires", std::int64_t{}},
                        {"spacing", 0.0},
                        {"a", 0.0},
                        {"s0", 0.0},
                        {"z0", 0.0},
                        {"sigma_a", 0.0},
                        {"sag", 0.0},
                        {"sigma_sag", 0.0},
                        {"length", 0.0},
                        {"sigma_middle", 0.0},
                        {"sigma_return", 0.0},
                        {"returns", std::int64_t{}},
                        {"whole", std::int64_t{}}},
                       {}};
  for (size_t k = 0; k < r.lines.conductors.size(); ++k) {
    const terrain::Conductor& c = r.lines.conductors[k];
    const terrain::CatenaryFit& fit = c.strand.fit;
    const double a = fit.curve.a(), middle = 0.5 * (c.first.s + c.last.s);
    out.features.push_back(
        {mapped(vertices(c), map),
         {conductor_name(r.lines, k), whole(c.span + 1), std::int64_t{c.wires}, c.wires > 1 ? c.spacing : none, a,
          fit.curve.s0() - c.first.s, fit.curve.z0() + map.context.origin.z(), a * a * std::sqrt(fit.covariance(2, 2)),
          c.sag ? c.sag->value : none, c.sag ? c.sag->sigma : none, c.last.s - c.first.s, std::hypot(fit.sigma_z(middle), fit.sigma_lines),
          fit.sigma, whole(c.strand.points.size()), std::int64_t{c.first.known && c.last.known}}});
  }
  return out;
}

io::SpatialLayer spans(const PowerLineResult& r, const OnMap& map) {
  io::SpatialLayer out{"spans",
                       "Axis of each span",
                       io::SpatialShape::line,
                       false,
                       {{"span", std::int64_t{}},
                        {"length", 0.0},
                        {"conductors", std::int64_t{}},
                        {"pylon_first", std::string()},
                        {"pylon_last", std::string()}},
                       {}};
  for (size_t k = 0; k < r.lines.spans.size(); ++k) {
    const terrain::Span& s = r.lines.spans[k];
    double z = 0.0;
    for (const size_t c : s.conductors) z += r.lines.conductors[c].strand.fit.curve.level / static_cast<double>(s.conductors.size());
    const Eigen::Vector2d a = s.axis.at(s.first), b = s.axis.at(s.last);
    out.features.push_back(
        {{map({a.x(), a.y(), z}), map({b.x(), b.y(), z})},
         {whole(k + 1), s.length(), whole(s.conductors.size()), pylon_number(s.pylon_first), pylon_number(s.pylon_last)}});
  }
  return out;
}

io::SpatialLayer pylons(const PowerLineResult& r, const OnMap& map) {
  io::SpatialLayer out{"pylons",
                       "Supports: their top, returns of class 15 (0: known by the wires alone)",
                       io::SpatialShape::point,
                       false,
                       {{"pylon", std::int64_t{}}, {"sigma", 0.0}, {"returns", std::int64_t{}}, {"spans", std::int64_t{}}},
                       {}};
  for (size_t k = 0; k < r.lines.pylons.size(); ++k) {
    const terrain::Pylon& p = r.lines.pylons[k];
    out.features.push_back({{map({p.at.x(), p.at.y(), p.top})},
                            {whole(k + 1), std::sqrt(0.5 * p.covariance.trace()), whole(p.returns), whole(p.spans.size())}});
  }
  return out;
}

io::SpatialLayer clearances(const PowerLineResult& r, const OnMap& map) {
  io::SpatialLayer out{"clearances",
                       "Smallest distances, from the wire to the nearest place; m",
                       io::SpatialShape::line,
                       false,
                       {{"conductor", std::string()},
                        {"to", std::string()},
                        {"at_rest", 0.0},
                        {"sigma", 0.0},
                        {"swung", 0.0},
                        {"limit", 0.0},
                        {"kept", std::int64_t{}},
                        {"other", std::string()}},
                       {}};
  for (size_t k = 0; k < r.clearances.size(); ++k)
    for (const terrain::Clearance& c : r.clearances[k].smallest)
      out.features.push_back(
          {{map(c.wire), map(c.other)},
           {conductor_name(r.lines, k), std::string(terrain::hazard_names[static_cast<size_t>(c.kind)]), c.at_rest, c.sigma, c.swung,
            c.limit, std::int64_t{c.is_kept()}, c.conductor ? conductor_name(r.lines, *c.conductor) : std::string()}});
  return out;
}

io::SpatialLayer infringements(const PowerLineResult& r, const OnMap& map) {
  io::SpatialLayer out{"infringements", "Returns nearer than their limit, the nearest of each square metre",      io::SpatialShape::point,
                       false,           {{"conductor", std::string()}, {"of", std::string()}, {"distance", 0.0}}, {}};
  for (size_t k = 0; k < r.clearances.size(); ++k)
    for (const terrain::Infringement& i : r.clearances[k].infringements)
      out.features.push_back(
          {{map(i.at)}, {conductor_name(r.lines, k), std::string(terrain::hazard_names[static_cast<size_t>(i.kind)]), i.distance}});
  return out;
}

io::SpatialLayer trees(const PowerLineResult& r, const OnMap& map) {
  io::SpatialLayer out{"falling_trees",
                       "Trees that come too near to a wire when they fall: tops; margin below 0: they reach it",
                       io::SpatialShape::point,
                       false,
                       {{"conductor", std::string()}, {"height", 0.0}, {"margin", 0.0}},
                       {}};
  for (const terrain::FallingTree& t : r.trees)
    out.features.push_back({{map(t.top)}, {conductor_name(r.lines, t.conductor), t.height, t.margin}});
  return out;
}

std::string sheet_title(const PowerLineResult& r, size_t span) {
  const terrain::Span& s = r.lines.spans[span];
  char text[200];
  std::snprintf(text, sizeof text, "Span %zu: %.1f m%s, %s", span + 1, s.length(), s.is_whole() ? "" : " (not whole)",
                core::counted(s.conductors.size(), "conductor").c_str());
  std::string out = text;
  for (int kind = 0; kind < terrain::hazards; ++kind) {
    const terrain::Clearance* smallest = nullptr;
    for (const size_t c : s.conductors)
      for (const terrain::Clearance& k : r.clearances[c].smallest)
        if (static_cast<int>(k.kind) == kind && (!smallest || k.swung < smallest->swung)) smallest = &k;
    if (!smallest) continue;
    std::snprintf(text, sizeof text, "; %s %.2f m (limit %.2f)%s", terrain::hazard_names[static_cast<size_t>(kind)], smallest->swung,
                  smallest->limit, smallest->is_kept() ? "" : " NOT KEPT");
    out += text;
  }
  return out;
}

}  // namespace

std::string conductor_name(const terrain::PowerLines& lines, size_t conductor) {
  const size_t span = lines.conductors[conductor].span;
  const std::vector<size_t>& all = lines.spans[span].conductors;
  return std::to_string(span + 1) + "." + std::to_string(std::find(all.begin(), all.end(), conductor) - all.begin() + 1);
}

std::vector<io::SpatialLayer> power_line_layers(const PowerLineResult& result, const Context& context) {
  const OnMap map{context};
  return {conductors(result, map), spans(result, map),         pylons(result, map),
          clearances(result, map), infringements(result, map), trees(result, map)};
}

report::Chart span_sheet(const PowerLineResult& r, size_t span, const std::vector<terrain::Obstacle>& obstacles, double beside,
                         double base) {
  const terrain::Span& s = r.lines.spans[span];
  constexpr std::array<const char*, 3> kinds{"ground", "vegetation", "building"};
  constexpr std::array<int, 3> colours{4, 2, 5};
  constexpr std::array<int, 4> of_wires{0, 1, 3, 6};
  report::Panel profile{"Along the span", "distance along the span (m)", "height (m)", {}},
      plan{"From above", "distance along the span (m)", "to the left (m)", {}};
  for (size_t kind = 0; kind < kinds.size(); ++kind) {
    report::Series up{kinds[kind], {}, {}, {}, report::Mark::dots, colours[kind]};
    report::Series down = up;
    for (const terrain::Obstacle& o : obstacles) {
      const double along = s.axis.s({o.x, o.y}), across = s.axis.v({o.x, o.y});
      if (static_cast<size_t>(o.kind) != kind || along < s.first - 5.0 || along > s.last + 5.0 || std::abs(across) > beside) continue;
      up.x.push_back(along - s.first), up.y.push_back(o.z + base);
      down.x.push_back(along - s.first), down.y.push_back(across);
    }
    const size_t step = up.x.size() / drawn_returns + 1;
    for (report::Series* series : {&up, &down}) {
      for (size_t k = 0; k * step < series->x.size(); ++k) series->x[k] = series->x[k * step], series->y[k] = series->y[k * step];
      const size_t left = (series->x.size() + step - 1) / step;
      series->x.resize(left), series->y.resize(left);
    }
    if (up.x.empty()) continue;
    profile.series.push_back(std::move(up));
    if (kind > 0) plan.series.push_back(std::move(down));
  }
  for (const size_t k : s.conductors) {
    const terrain::Conductor& c = r.lines.conductors[k];
    report::Series up{conductor_name(r.lines, k), {}, {}, {}, report::Mark::line, of_wires[k % of_wires.size()]};
    report::Series down = up;
    for (const Eigen::Vector3d& p : vertices(c)) {
      up.x.push_back(s.axis.s(p.head<2>()) - s.first), up.y.push_back(p.z() + base);
      down.x.push_back(up.x.back()), down.y.push_back(s.axis.v(p.head<2>()));
    }
    profile.series.push_back(std::move(up));
    plan.series.push_back(std::move(down));
  }
  return {sheet_title(r, span), {profile, plan}, 1400, 420};
}

}  // namespace swath::stages
