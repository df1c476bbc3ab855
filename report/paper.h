// SPDX-License-Identifier: GPL-3.0-or-later
// A report as sheets of A4, a PDF: what report/page.h is for the screen.
#pragma once

#include <string>
#include <vector>

#include "core/picture.h"
#include "report/canvas.h"
#include "report/page.h"

namespace swath::report {

/// Sheets are filled from above; what does not fit goes to the next one, rows of a table with its heads again. Throws core::Error for rows
/// longer than the columns.
class Paper {
 public:
  explicit Paper(const std::string& title, const std::string& subtitle = {});

  void banner(Tone tone, const std::string& text);
  void section(const std::string& heading, int level = 2);
  void paragraph(const std::string& text);
  void list(const std::vector<std::string>& items);
  /// A table that is too wide is set smaller, to three fifths of the usual size at most; then its texts are set narrower.
  void table(const Table& table);
  /// As wide as the sheet at most, and never larger than it is.
  void figure(const Drawing& drawing, const std::string& caption);
  void figure(core::Picture picture, const std::string& caption);

  size_t sheets() const { return sheets_.size(); }
  std::string pdf() const;

 private:
  using Ink = std::function<void(Canvas&)>;
  void draw(Ink ink) { sheets_.back().push_back(std::move(ink)); }
  void text(const std::string& utf8, double x, double size, core::Rgb colour, bool bold);
  /// Breaks it into lines; every one is drawn by itself, so that a paragraph may go on on the next sheet.
  void flow(const std::string& utf8, double x, double size, core::Rgb colour, bool bold = false);
  void make_room(double height);

  std::string title_;
  std::vector<std::vector<Ink>> sheets_;
  double y_ = 0.0;
  int tables_ = 0, figures_ = 0;
};

}  // namespace swath::report
