// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/tables.h"

#include <cmath>

#include "calib/report/residual_bins.h"
#include "core/config/units.h"
#include "core/printable.h"

namespace swath::calib {
namespace {

/// Rows of one CSV file.
class Csv {
 public:
  explicit Csv(const char* head) : text_(std::string(head) + "\n") {}
  Csv& operator<<(double v) { return put(std::isfinite(v) ? core::format_number(v) : ""); }
  Csv& operator<<(std::uint64_t v) { return put(std::to_string(v)); }
  Csv& operator<<(int v) { return put(std::to_string(v)); }
  Csv& operator<<(std::string_view v) { return put(core::csv_field(v)); }
  void end() {
    text_ += "\n";
    first_ = true;
  }
  std::string text() && { return std::move(text_); }

 private:
  Csv& put(const std::string& field) {
    if (!first_) text_ += ",";
    first_ = false;
    text_ += field;
    return *this;
  }
  std::string text_;
  bool first_ = true;
};

}  // namespace

std::string differences_after(const CalibrationReport& report) {
  if (report.joint) return "Before: with the smoother's trajectory and the start values. After: with the adjusted trajectory and values.";
  return report.strips ? "Before: with the trajectory as it was given. After: with the corrected trajectory."
                       : "Before: with the start values. After: with the delivered calibration and the trajectory as it was given, as in a "
                         "survey that uses this calibration; the corrections of the lines (corrections.csv) are not in it.";
}

const char* tree_file(const CalibrationReport& report) {
  return report.joint ? "adjustment.json" : report.strips ? "strips.json" : "calibration.json";
}

std::string difference_file(const LineDifference& d, bool before) {
  return "differences/" + std::to_string(d.line_a) + "_" + std::to_string(d.line_b) + (before ? "_before.tif" : "_after.tif");
}

std::string residuals_csv(const CalibrationReport& report) {
  Csv csv("plane,kind,line,returns,time_s,scan_angle_deg,range_m,before_m,after_m,rms_m,redundancy,w,rejected");
  for (const calib::GroupResidual& g : report.adjustment.groups) {
    csv << static_cast<std::uint64_t>(g.plane) << calib::name_of(report.ties.planes[g.plane].kind) << report.ties.lines[g.line].id
        << static_cast<std::uint64_t>(g.returns) << bin_value(g, report.ties, BinBy::time) << bin_value(g, report.ties, BinBy::angle)
        << g.range << g.before << g.after << g.rms << g.redundancy << g.w << static_cast<int>(g.rejected);
    csv.end();
  }
  return std::move(csv).text();
}

std::string corrections_csv(const CalibrationReport& report) {
  Csv csv(
      "line,time_s,north_m,east_m,down_m,roll_rad,pitch_rad,heading_rad,sigma_north_m,sigma_east_m,sigma_down_m,sigma_roll_rad,"
      "sigma_pitch_rad,sigma_heading_rad,apriori_north_m,apriori_east_m,apriori_down_m,apriori_roll_rad,apriori_pitch_rad,"
      "apriori_heading_rad");
  const double first = first_time(report.ties);
  for (const calib::LineCorrection& c : report.adjustment.corrections)
    for (size_t k = 0; k < c.time.size(); ++k) {
      csv << c.line << c.time[k] - first;
      for (const auto* columns : {&c.value, &c.sigma, &c.apriori})
        for (size_t axis = 0; axis < 6; ++axis) csv << (k < columns->size() ? (*columns)[k][axis] : calib::not_known);
      csv.end();
    }
  return std::move(csv).text();
}

std::string planes_csv(const CalibrationReport& report) {
  Csv csv(
      "plane,kind,name,east_m,north_m,up_m,normal_east,normal_north,normal_up,half_u_m,half_v_m,roughness_m,sigma_height_m,control_points,"
      "groups");
  std::vector<std::uint64_t> groups(report.ties.planes.size());
  for (const calib::TieGroup& g : report.ties.groups) ++groups[g.plane];
  const bool adjusted = report.adjustment.planes.size() == report.ties.planes.size();
  for (size_t k = 0; k < report.ties.planes.size(); ++k) {
    const calib::TiePlane& found = report.ties.planes[k];
    const calib::TiePlane& p = adjusted ? report.adjustment.planes[k] : found;
    csv << static_cast<std::uint64_t>(k) << calib::name_of(found.kind) << found.name << p.centre[0] << p.centre[1] << p.centre[2]
        << p.normal[0] << p.normal[1] << p.normal[2] << found.half[0] << found.half[1] << found.roughness
        << (k < report.adjustment.plane_sigma.size() ? report.adjustment.plane_sigma[k][0] : calib::not_known)
        << static_cast<std::uint64_t>(found.control.size()) << groups[k];
    csv.end();
  }
  return std::move(csv).text();
}

std::string sections_csv(const CalibrationReport& report) {
  Csv csv("section,state,line,along_m,height_m");
  for (size_t s = 0; s < report.sections.size(); ++s)
    for (const bool before : {true, false})
      for (const SectionPoints& points : before ? report.sections[s].before : report.sections[s].after)
        for (size_t k = 0; k < points.along.size(); ++k) {
          csv << static_cast<std::uint64_t>(s) << std::string_view(before ? "before" : "after") << points.line << points.along[k]
              << points.height[k];
          csv.end();
        }
  return std::move(csv).text();
}

}  // namespace swath::calib
