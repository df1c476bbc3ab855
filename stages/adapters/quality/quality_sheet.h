// SPDX-License-Identifier: GPL-3.0-or-later
// One report filled once: a page for the screen and sheets of A4.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/chart.h"
#include "report/page.h"
#include "report/paper.h"

namespace swath::stages {

class QualitySheet {
 public:
  QualitySheet(const std::string& title, const std::string& subtitle) : page_(title, subtitle), paper_(title, subtitle) {}

  void banner(report::Tone tone, const std::string& text) { page_.banner(tone, text), paper_.banner(tone, text); }
  void section(const std::string& heading, int level = 2) { page_.section(heading, level), paper_.section(heading, level); }
  void paragraph(const std::string& text) { page_.paragraph(text), paper_.paragraph(text); }
  void list(const std::vector<std::string>& items) { page_.list(items), paper_.list(items); }
  void table(const report::Table& t) { page_.table(t), paper_.table(t); }
  /// Keeps the chart until the sheets are drawn.
  void chart(report::Chart chart, const std::string& caption, const std::string& file = {});
  /// A PNG file.
  void map(const std::filesystem::path& file, const std::string& caption);

  std::string html() const { return page_.html(); }
  std::string pdf() const { return paper_.pdf(); }

 private:
  report::Page page_;
  report::Paper paper_;
};

}  // namespace swath::stages
