// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/check_columns.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/crs.h"
#include "core/printable.h"
#include "io/las/las_crs.h"
#include "io/las/las_ending.h"
#include "io/las/las_reader.h"
#include "io/survey/column_roles.h"
#include "io/text/fields.h"
#include "io/text/line_reader.h"
#include "io/text/text_table.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;

constexpr double near_by = 1000.0;  // units of the CRS: check points may lie beside the cloud
constexpr const char* how_to_state = "name them by --check-columns NAME,X,Y,Z, by their names or their numbers from 1, such as ";

/// The box of a cloud.
struct CloudBox {
  Vector2d low, high;
  std::string crs;
};

std::vector<CloudBox> boxes_of(const CheckedClouds& clouds) {
  std::vector<CloudBox> out;
  for (const fs::path& file : clouds.files) {
    if (!io::has_las_ending(file)) continue;  // an index
    std::vector<std::string> ignored;
    const io::LasHeader header = io::read_las_header(file, ignored);
    const std::string stated = io::las_crs(header).definition;
    out.push_back({header.min.head<2>(), header.max.head<2>(), stated.empty() ? clouds.crs : stated});
  }
  return out;
}

/// Does a place of the check points' CRS lie in or near one of the boxes?
class Nearness {
 public:
  explicit Nearness(const CheckedClouds& clouds) : boxes_(boxes_of(clouds)) {
    const std::string own = !clouds.check_crs.empty() ? clouds.check_crs : clouds.crs;
    for (const CloudBox& box : boxes_) {
      to_box_.emplace_back();
      if (!own.empty() && own != box.crs) to_box_.back().emplace(core::Crs(own).horizontal(), core::Crs(box.crs).horizontal());
    }
  }
  bool is_near(const Vector2d& place) const {
    for (size_t k = 0; k < boxes_.size(); ++k) {
      Vector2d at = place;
      try {
        if (to_box_[k]) at = (*to_box_[k])({place.x(), place.y(), 0.0}).head<2>();
      } catch (const core::Error&) {
        continue;  // no place of that CRS
      }
      if ((at - boxes_[k].low).minCoeff() > -near_by && (boxes_[k].high - at).minCoeff() > -near_by) return true;
    }
    return false;
  }
  bool has_boxes() const { return !boxes_.empty(); }

 private:
  std::vector<CloudBox> boxes_;
  std::vector<std::optional<core::Transform>> to_box_;
};

/// A field's number; NaN where it is none.
double number_in(const io::TextTable& table, size_t row, size_t column) {
  double value = 0;
  return io::read_number(table.pointed(row, column), value) ? value : std::numeric_limits<double>::quiet_NaN();
}

bool holds_numbers(const io::TextTable& table, size_t column) {
  size_t numbers = 0, texts = 0;
  for (size_t row = 0; row < table.rows(); ++row)
    if (!table.text(row, column).empty()) ++(std::isfinite(number_in(table, row, column)) ? numbers : texts);
  return numbers > texts;
}

/// Easting and northing side by side, the height behind them.
struct Candidate {
  size_t x = 0, y = 0, z = 0;
  size_t near = 0;  ///< points that lie in or near the cloud
};

/// Those by which half of the points lie there.
std::vector<Candidate> fitting(const io::TextTable& table, const Nearness& clouds) {
  std::vector<Candidate> out;
  for (size_t first = 0; first + 2 < table.columns(); ++first) {
    if (!holds_numbers(table, first) || !holds_numbers(table, first + 1) || !holds_numbers(table, first + 2)) continue;
    for (Candidate c : {Candidate{first, first + 1, first + 2}, Candidate{first + 1, first, first + 2}}) {
      for (size_t row = 0; row < table.rows(); ++row)
        if (const Vector2d at(number_in(table, row, c.x), number_in(table, row, c.y)); at.allFinite() && clouds.is_near(at)) ++c.near;
      if (2 * c.near >= table.rows()) out.push_back(c);
    }
  }
  return out;
}

std::string number_from_one(size_t column) { return std::to_string(column + 1); }

CheckColumns by_place(const fs::path& file, const io::TextTable& table, const CheckedClouds& clouds) {
  const Nearness nearness(clouds);
  const auto refuse = [&](const std::string& why) {
    throw core::usage_error(
        "the file has no header, and " + why, file.string(),
        std::string(how_to_state) + "1,2,3,4 for name, easting, northing, height; or 1,3,2,4 where the northing is first");
  };
  if (!nearness.has_boxes()) refuse("an index of clouds does not show which columns hold easting and northing");
  const std::vector<Candidate> found = fitting(table, nearness);
  if (found.empty())
    refuse("no two columns side by side put the points in or near the cloud" +
           std::string(clouds.check_crs.empty() ? " (are they in another CRS? --check-crs names it)" : ""));
  if (found.size() > 1) refuse("its points lie in or near the cloud by more than one order of the columns");
  const Candidate& c = found[0];
  CheckColumns out;
  const size_t first = std::min(c.x, c.y);
  if (first > 0) out.name = "1";
  out.x = number_from_one(c.x), out.y = number_from_one(c.y), out.z = number_from_one(c.z);
  out.note = file.string() + " has no header: column " + out.x + " is taken as easting, " + out.y + " as northing, " + out.z +
             " as height" + (first > 0 ? ", 1 as name" : "") + ": so " + std::to_string(c.near) + " of " +
             core::counted(table.rows(), "point") + (c.near == 1 ? " lies" : " lie") + " in or near the cloud (--check-columns " +
             (first > 0 ? "1," : "") + out.x + "," + out.y + "," + out.z + ")";
  return out;
}

CheckColumns as_stated(const fs::path& file, const io::TextTable& table, const std::string& stated) {
  std::vector<std::string> names = io::split_delimited(stated, ',');
  if (names.size() == 3) names.insert(names.begin(), "");
  if (names.size() != 4 || std::any_of(names.begin() + 1, names.end(), [](const std::string& n) { return n.empty(); }))
    throw core::usage_error("is no list of three or four columns", "--check-columns " + stated,
                            "name,easting,northing,height by their names or their numbers from 1: 1,3,2,4");
  try {
    for (const std::string& name : names)
      if (!name.empty()) table.column(name);
  } catch (const core::Error& e) {
    throw core::usage_error(e.what(), "--check-columns " + stated + ": " + file.string(), e.hint());
  }
  return {names[0], names[1], names[2], names[3], {}};
}

}  // namespace

CheckColumns check_columns(const fs::path& file, const std::string& stated, const CheckedClouds& clouds) {
  if (core::lower_case(file.extension().string()) == ".gpkg") return {};
  std::error_code ec;
  if (!fs::exists(file, ec)) return {};  // its reader says so
  const io::TextTable table(file, {}, io::Header::if_any);
  if (!stated.empty()) return as_stated(file, table, stated);
  if (table.names().empty()) return by_place(file, table, clouds);
  const io::ColumnRoles roles = io::roles_of_control(table.names());
  if (roles.kind == io::TableKind::control) return {};
  std::string list;
  for (const std::string& name : table.names()) list += (list.empty() ? "" : ", ") + name;
  throw core::usage_error("the columns of easting, northing and height are not known by their names; columns: " + list, file.string(),
                          std::string(how_to_state) + "1,2,3,4");
}

}  // namespace swath::pipeline
