// SPDX-License-Identifier: GPL-3.0-or-later
// A report as one HTML file: nothing is loaded from elsewhere and no script runs, so that it can be mailed, archived and printed.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace swath::report {

/// How a banner or a row is meant.
enum class Tone { plain, good, caution, bad };

struct Column {
  std::string head;     ///< with the unit: "height (m)"
  bool numbers = true;  ///< set to the right, digits of one width; otherwise texts, to the left
};

/// Cells are texts (report/html.h makes numbers). Rows shorter than the columns end in empty cells.
struct Table {
  std::string id;  ///< of the element, for links and checks: letters, digits, hyphens; empty: none
  std::string caption;
  std::vector<Column> columns;
  std::vector<std::vector<std::string>> rows;
  std::vector<Tone> tones;  ///< by row; empty or shorter: plain
};

/// A table of names and their values.
Table value_table(const std::string& caption, const std::vector<std::pair<std::string, std::string>>& rows);

/// A page is filled from above. All texts are UTF-8 and plain: what HTML would read as its own is escaped. Throws core::Error for rows
/// longer than the columns.
class Page {
 public:
  explicit Page(std::string title, std::string subtitle = {});

  /// The verdict, under the title, whenever it is said.
  void banner(Tone tone, std::string text);
  /// Starts a section and lists it in the contents; `level` 2, or 3 within one.
  void section(const std::string& heading, int level = 2);
  void paragraph(const std::string& text);
  void list(const std::vector<std::string>& items);
  void table(const Table& table);
  /// A drawing as SVG (report/chart.h), set into the page; ids within it are made its own. `file`: where it stands as a file beside the
  /// page, to be named in the caption; may be empty.
  void figure_svg(std::string_view svg, const std::string& caption, const std::string& file = {});
  /// A picture as the bytes of a PNG file.
  void figure_png(std::string_view png, const std::string& caption, const std::string& file = {});
  /// Keeps a footnote; what it returns is put into a text given to this page, where its number is to stand.
  std::string footnote(const std::string& text);

  /// The whole file.
  std::string html() const;

 private:
  struct Entry {
    int level;
    std::string id, heading;
  };
  std::string inline_html(std::string_view text) const;
  std::string unique_id(std::string_view heading) const;
  void figure(const std::string& what, const std::string& caption, const std::string& file);

  std::string title_, subtitle_, body_;
  Tone tone_ = Tone::plain;
  std::string verdict_;
  std::vector<Entry> contents_;
  std::vector<std::string> footnotes_;
  int tables_ = 0, figures_ = 0;
};

}  // namespace swath::report
