// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "stages/adapters/quality/quality_tables.h"

namespace swath::stages {

report::Table fact_table(const std::string& caption, const std::vector<FactColumn>& columns, const std::vector<Facts>& rows) {
  report::Table t;
  t.caption = caption;
  for (const FactColumn& c : columns) t.columns.push_back({c.head, c.decimals >= 0});
  for (const Facts& row : rows) {
    std::vector<std::string> cells;
    for (const FactColumn& c : columns)
      cells.push_back(c.decimals < 0 ? row.text(c.key) : report::number_text(c.scale * row.number(c.key), c.decimals));
    t.rows.push_back(std::move(cells));
  }
  return t;
}

void add_map(QualitySheet& page, const std::filesystem::path& file, const std::string& caption) {
  if (!file.empty()) page.map(file, caption);
}

void add_histogram(QualitySheet& page, const Facts& from, const std::string& x_label, const std::string& caption) {
  const std::vector<double> middles = from.numbers("bins_m"), cells = from.numbers("bin_cells");
  if (middles.size() < 3) return;
  double width = middles[1] - middles[0];
  for (size_t k = 2; k < middles.size(); ++k) width = std::min(width, middles[k] - middles[k - 1]);
  report::Series s;
  s.mark = report::Mark::band;
  const auto add = [&s](double x, double y) {
    s.x.push_back(100.0 * x);
    s.y.push_back(y);
    s.y2.push_back(0.0);
  };
  const double edge = 0.03 * width;  // steep, for a band has one height at each place
  for (size_t k = 0; k < middles.size(); ++k) {
    const double left = middles[k] - 0.5 * width, right = middles[k] + 0.5 * width;
    if (k == 0 || middles[k] - middles[k - 1] > 1.5 * width) add(left - edge, 0.0);
    add(left + edge, cells[k]);
    add(right - edge, cells[k]);
    if (k + 1 == middles.size() || middles[k + 1] - middles[k] > 1.5 * width) add(right + edge, 0.0);
  }
  report::Panel panel;
  panel.x_label = x_label;
  panel.y_label = "cells";
  panel.series = {s};
  report::Chart chart;
  chart.panels.push_back(panel);
  page.chart(std::move(chart), caption);
}

}  // namespace swath::stages
