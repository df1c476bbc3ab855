// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/calibration_report.h"

#include <system_error>

#include "calib/report/page.h"
#include "calib/report/report_tree.h"
#include "calib/report/tables.h"
#include "core/grid_units.h"
#include "io/raster/geotiff.h"
#include "io/raster/png.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"

namespace swath::calib {

std::vector<std::string> write_calibration_report(const CalibrationReport& report, const std::filesystem::path& folder) {
  std::vector<std::string> written;
  const auto named = [&](const std::string& name) {
    written.push_back(name);
    std::error_code failed;  // what cannot be made is reported by the file that has no place
    std::filesystem::create_directories((folder / name).parent_path(), failed);
    return folder / name;
  };
  const auto text = [&](const char* name, const std::string& content) { io::write_text_file(named(name), content); };
  text("residuals.csv", residuals_csv(report));
  text("corrections.csv", corrections_csv(report));
  text("planes.csv", planes_csv(report));
  text("sections.csv", sections_csv(report));
  for (const LineDifference& d : report.differences)
    for (const bool before : {true, false})
      io::write_grid(named(difference_file(d, before)), core::in_units(report.unit, report.vertical_unit, before ? d.before : d.after),
                     report.crs);
  const std::string page = calibration_page(report, [&](const std::string& file, const core::Picture& picture) {
    const std::string bytes = io::png_bytes(picture, file);
    io::write_text_file(named(file), bytes);
    return bytes;
  });
  text("report.html", page);
  // Last: where it stands, the report beside it is whole.
  text(tree_file(report), io::to_json(calibration_report_tree(report)));
  return written;
}

}  // namespace swath::calib
