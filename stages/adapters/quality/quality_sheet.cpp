// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/quality/quality_sheet.h"

#include <memory>

#include "io/raster/png.h"
#include "io/text/value_file.h"

namespace swath::stages {

void QualitySheet::chart(report::Chart chart, const std::string& caption, const std::string& file) {
  const auto kept = std::make_shared<report::Chart>(std::move(chart));
  page_.figure_svg(report::svg(*kept), caption, file);
  report::Drawing drawing = report::drawing(*kept);
  drawing.paint = [kept, paint = std::move(drawing.paint)](report::Canvas& c) { paint(c); };
  paper_.figure(drawing, caption);
}

void QualitySheet::map(const std::filesystem::path& file, const std::string& caption) {
  page_.figure_png(io::read_text_file(file), caption, file.filename().string());
  paper_.figure(io::read_png(file), caption);
}

}  // namespace swath::stages
