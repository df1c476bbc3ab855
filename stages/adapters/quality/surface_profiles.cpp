// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/quality/surface_profiles.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "io/text/output_file.h"
#include "io/vector/vector.h"

namespace swath::stages {
namespace {

constexpr double max_places = 2000.0;  // of a profile: more than a chart can show
constexpr size_t places_at_once = 100;

std::string text_of(double v, double unit) {
  if (!std::isfinite(v)) return {};
  char text[40];
  std::snprintf(text, sizeof text, "%.3f", v / unit);
  return text;
}

/// Places every `step` along the line, and its last point.
void add_places(const SectionLine& line, double step, SurfaceProfile& p) {
  double begin = 0.0, next = 0.0;  // along the line: of the piece, of the next place
  for (size_t k = 1; k < line.vertices.size(); ++k) {
    const Eigen::Vector2d a = line.vertices[k - 1], b = line.vertices[k];
    const double length = (b - a).norm();
    for (; next <= begin + length && length > 0.0; next += step) {
      const Eigen::Vector2d at = a + (b - a) * ((next - begin) / length);
      p.along.push_back(next), p.x.push_back(at.x()), p.y.push_back(at.y());
    }
    begin += length;
  }
}

double length_of(const SectionLine& line) {
  double sum = 0.0;
  for (size_t k = 1; k < line.vertices.size(); ++k) sum += (line.vertices[k] - line.vertices[k - 1]).norm();
  return sum;
}

}  // namespace

std::vector<SectionLine> section_lines(const Context& context, const std::filesystem::path& file) {
  const io::VectorLines read = io::read_lines(file);
  std::optional<core::Transform> to_map;
  if (!read.crs_wkt.empty() && !context.crs.empty()) to_map.emplace(core::Crs(read.crs_wkt).horizontal(), context.crs.horizontal());
  std::vector<SectionLine> out;
  for (const io::VectorLine& l : read.lines) {
    SectionLine line{"line " + std::to_string(out.size() + 1), {}};
    for (size_t k = 0; k < l.x.size(); ++k) {
      const Eigen::Vector3d at = to_map ? (*to_map)({l.x[k], l.y[k], 0.0}) : Eigen::Vector3d(l.x[k], l.y[k], 0.0);
      if (at.head<2>().allFinite()) line.vertices.push_back(context.unit * at.head<2>());
    }
    if (length_of(line) > 0.0) out.push_back(std::move(line));
  }
  if (out.empty()) throw core::usage_error("the file holds no line", file.string(), "quality.surface.profiles wants lines to cut along");
  return out;
}

std::vector<SectionLine> middle_lines(const Box& b) {
  const double x = 0.5 * (b.x0 + b.x1), y = 0.5 * (b.y0 + b.y1);
  return {{"west to east", {{b.x0, y}, {b.x1, y}}}, {"south to north", {{x, b.y0}, {x, b.y1}}}};
}

SurfaceProfile profile_along(const SectionLine& line, double cell, const HeightsAt& model, const HeightsAt& reference) {
  SurfaceProfile p{line.name, {}, {}, {}, {}, {}};
  add_places(line, std::max(cell, length_of(line) / max_places), p);
  for (size_t begin = 0; begin < p.x.size(); begin += places_at_once) {
    std::vector<Eigen::Vector2d> places;
    Box around{p.x[begin], p.y[begin], p.x[begin], p.y[begin]};
    for (size_t k = begin; k < std::min(p.x.size(), begin + places_at_once); ++k) {
      places.emplace_back(p.x[k], p.y[k]);
      around = {std::min(around.x0, p.x[k]), std::min(around.y0, p.y[k]), std::max(around.x1, p.x[k]), std::max(around.y1, p.y[k])};
    }
    for (const auto& [heights, of] : {std::pair(&p.model, &model), std::pair(&p.reference, &reference)}) {
      const std::vector<double> found = (*of)(places, around.grown(2.0 * cell));
      heights->insert(heights->end(), found.begin(), found.end());
    }
  }
  return p;
}

void write_profiles(const Context& context, const std::string& name, const std::vector<SurfaceProfile>& profiles) {
  std::string out = "profile,along,x,y,model,reference,difference\n";
  for (const SurfaceProfile& p : profiles)
    for (size_t k = 0; k < p.along.size(); ++k)
      out += p.name + "," + text_of(p.along[k], context.unit) + "," + text_of(p.x[k], context.unit) + "," + text_of(p.y[k], context.unit) +
             "," + text_of(p.model[k], context.vertical_unit) + "," + text_of(p.reference[k], context.vertical_unit) + "," +
             text_of(p.model[k] - p.reference[k], context.vertical_unit) + "\n";
  io::write_text_file(context.output / (name + ".csv"), out);
}

}  // namespace swath::stages
