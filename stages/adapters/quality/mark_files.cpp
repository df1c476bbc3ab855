// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/quality/mark_files.h"

#include <cmath>
#include <cstdio>

#include "core/geo/height_unit.h"
#include "core/printable.h"
#include "io/text/output_file.h"
#include "io/vector/feature_layers.h"

namespace swath::stages {
namespace {

/// "3:0.0123 7:-0.0045": the difference of each line at a mark.
std::string by_line(const std::vector<quality::MarkReading>& readings, size_t mark) {
  std::string out;
  char text[60];
  for (const quality::MarkReading& r : readings) {
    if (static_cast<size_t>(r.mark) != mark) continue;
    std::snprintf(text, sizeof text, "%s%d:%.4f", out.empty() ? "" : " ", r.line, static_cast<double>(r.difference));
    out += text;
  }
  return out;
}

/// Empty where it is not finite.
std::string cell_of(double v) {
  if (!std::isfinite(v)) return {};
  char text[40];
  std::snprintf(text, sizeof text, "%.4f", v);
  return text;
}

}  // namespace

bool holds_check_points(const io::ControlFile& file) { return file.use == io::ControlUse::check && file.kind == io::ControlKind::xyz; }

std::vector<CheckFileRead> tables_read(const io::Survey& survey) {
  std::vector<CheckFileRead> out;
  for (const io::ControlFile& f : survey.control)
    if (holds_check_points(f) && core::lower_case(f.file.extension().string()) != ".gpkg")
      out.push_back({f.file.string(), f.name, f.x, f.y, f.z});
  return out;
}

void write_marks(const Context& context, const std::string& name, const std::vector<quality::CheckMark>& marks,
                 const std::vector<MarkFound>& found, const std::vector<quality::MarkReading>& readings) {
  std::string table =
      "name,x,y,z,sigma,cover,points_minus_mark,dtm_minus_mark,predicted_sigma,slope,lines,unit,height_unit,difference_unit\n";
  const std::string unit = core::unit_symbol(context.unit), height_unit = core::unit_symbol(context.vertical_unit);
  const std::string units = "," + core::csv_field(unit) + "," + core::csv_field(height_unit) + ",m\n";
  io::FeatureLayer layer{"marks",
                         "Check points; z in " + height_unit + ", sigmas and differences (product minus check point) in m",
                         io::FeatureShape::point,
                         {"name", "cover", "place", "lines"},
                         {"z", "sigma", "points_minus_mark", "dtm_minus_mark", "predicted_sigma", "slope"},
                         {}};
  char text[200];
  for (size_t m = 0; m < marks.size(); ++m) {
    const quality::CheckMark& mark = marks[m];
    const MarkFound& f = found[m];
    const double x = mark.at.x() / context.unit, y = mark.at.y() / context.unit, z = mark.at.z() / context.vertical_unit;
    const double sigma = f.sigma > 0.0 ? f.sigma : std::nan("");
    const std::string lines = by_line(readings, m);
    std::snprintf(text, sizeof text, ",%.3f,%.3f,%.3f,%.4f,", x, y, z, mark.sigma);
    table += core::csv_field(mark.name) + text + core::csv_field(mark.cover) + "," + cell_of(f.points) + "," + cell_of(f.dtm) + "," +
             cell_of(sigma) + "," + cell_of(f.slope) + "," + lines + units;
    layer.features.push_back({{{{x, y}}}, {mark.name, mark.cover, mark.place, lines}, {z, mark.sigma, f.points, f.dtm, sigma, f.slope}});
  }
  io::write_text_file(context.output / (name + ".csv"), table);
  io::write_feature_layers(context.output / (name + ".gpkg"), {layer}, context.product_crs);
}

}  // namespace swath::stages
