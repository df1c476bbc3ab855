// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/paper.h"

#include <algorithm>
#include <memory>

#include "core/error.h"

namespace swath::report {
namespace {

constexpr int sheet_width = 794, sheet_height = 1123;  // A4 at 96 pixels to an inch
constexpr double margin = 57.0, foot = 40.0;           // 15 mm; the line with the number of the sheet
constexpr double inner_width = sheet_width - 2.0 * margin, bottom = sheet_height - margin - foot;
constexpr double body_size = 12.0, cell_size = 10.5, smallest_cells = 0.6, leading = 1.4, gap_between_cells = 10.0;
constexpr double figure_share = 0.8;  // of a sheet's height, at most
constexpr core::Rgb ink{28, 33, 38}, soft{89, 99, 110}, rule{211, 217, 223}, shade{244, 246, 248};

core::Rgb back_of(Tone tone) {
  switch (tone) {
    case Tone::good:
      return {233, 246, 238};
    case Tone::caution:
      return {255, 246, 224};
    case Tone::bad:
      return {253, 236, 235};
    case Tone::plain:
      break;
  }
  return shade;
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> out;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find(' ', at), text.size());
    if (end > at) out.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

/// Lines of whole words; a word that is wider than the room has a line of its own.
std::vector<std::string> lines_of(const std::string& text, double size, bool bold, double room) {
  std::vector<std::string> out;
  for (const std::string& word : words_of(text)) {
    if (!out.empty() && text_width(out.back() + " " + word, size, bold) <= room)
      out.back() += " " + word;
    else
      out.push_back(word);
  }
  return out;
}

Box box_of(double x, double y, double width, double height) {
  return {static_cast<int>(x), static_cast<int>(y), static_cast<int>(width), static_cast<int>(height)};
}

/// A table's measures: size of its letters, widths of its columns, lines of its heads.
struct Measures {
  double size = cell_size;
  std::vector<double> widths;
  std::vector<std::vector<std::string>> heads;
  size_t head_lines = 1;
  double width() const {
    double sum = 0.0;
    for (const double w : widths) sum += w;
    return sum;
  }
};

Measures measured_at(const Table& t, double size) {
  Measures m{size, {}, {}};
  for (size_t c = 0; c < t.columns.size(); ++c) {
    double width = 0.0;
    for (const std::string& word : words_of(t.columns[c].head)) width = std::max(width, text_width(word, size, true));
    for (const auto& row : t.rows)
      if (c < row.size()) width = std::max(width, text_width(row[c], size));
    m.heads.push_back(lines_of(t.columns[c].head, size, true, std::max(width, 60.0)));
    for (const std::string& line : m.heads.back()) width = std::max(width, text_width(line, size, true));
    m.head_lines = std::max(m.head_lines, m.heads.back().size());
    m.widths.push_back(width + gap_between_cells);
  }
  return m;
}

/// As large as fits; where even the smallest letters are too wide the widest column gives way, and its texts are set narrower.
Measures measures_of(const Table& t) {
  Measures m = measured_at(t, cell_size);
  if (m.width() > inner_width) m = measured_at(t, cell_size * std::max(smallest_cells, inner_width / m.width()));
  while (m.width() > inner_width + 1.0) {
    double& widest = *std::max_element(m.widths.begin(), m.widths.end());
    const double less = m.width() - inner_width;
    widest -= std::min(less, 0.2 * widest);
  }
  return m;
}

}  // namespace

Paper::Paper(const std::string& title, const std::string& subtitle) : title_(title), sheets_(1), y_(margin) {
  flow(title, margin, 22.0, ink, true);
  flow(subtitle, margin, body_size, soft);
  y_ += 8.0;
}

void Paper::make_room(double height) {
  if (y_ + height <= bottom || y_ <= margin) return;
  sheets_.emplace_back();
  y_ = margin;
}

void Paper::text(const std::string& utf8, double x, double size, core::Rgb colour, bool bold) {
  make_room(leading * size);
  draw([=, y = y_ + 0.5 * leading * size](Canvas& c) {
    c.text(x, y, utf8, {size, colour, Anchor::start, 0.0, bold, {}, sheet_width - margin - x});
  });
  y_ += leading * size;
}

void Paper::flow(const std::string& utf8, double x, double size, core::Rgb colour, bool bold) {
  for (const std::string& line : lines_of(utf8, size, bold, sheet_width - margin - x)) text(line, x, size, colour, bold);
}

void Paper::banner(Tone tone, const std::string& utf8) {
  const double height = 16.0 + leading * 14.0 * static_cast<double>(lines_of(utf8, 14.0, true, inner_width - 20.0).size());
  make_room(height);
  draw([=, y = y_](Canvas& c) { c.fill(box_of(margin, y, inner_width, height), back_of(tone)); });
  y_ += 8.0;
  flow(utf8, margin + 10.0, 14.0, ink, true);
  y_ += 16.0;
}

void Paper::section(const std::string& heading, int level) {
  y_ += level <= 2 ? 18.0 : 10.0;
  make_room(120.0);  // a heading and what begins below it stay together
  flow(heading, margin, level <= 2 ? 17.0 : 14.0, ink, true);
  if (level <= 2) draw([y = y_](Canvas& c) { c.fill(box_of(margin, y, inner_width, 1.0), rule); });
  y_ += 8.0;
}

void Paper::paragraph(const std::string& utf8) {
  flow(utf8, margin, body_size, ink);
  y_ += 6.0;
}

void Paper::list(const std::vector<std::string>& items) {
  for (const std::string& item : items) {
    make_room(leading * body_size);
    draw([y = y_ + 0.5 * leading * body_size](Canvas& c) { c.dots({margin + 6.0}, {y}, 1.8, ink); });
    flow(item, margin + 16.0, body_size, ink);
  }
  y_ += 6.0;
}

void Paper::table(const Table& t) {
  for (const auto& row : t.rows)
    if (row.size() > t.columns.size())
      throw core::Error("a row of a table has more cells than the table has columns", t.caption, "this is a fault of the program");
  const Measures m = measures_of(t);
  const double step = leading * m.size, head = step * static_cast<double>(m.head_lines), width = std::min(m.width(), inner_width);
  const auto cells = [&](const std::vector<std::string>& texts, double y, bool bold) {
    double x = margin;
    for (size_t c = 0; c < t.columns.size(); ++c) {
      const bool right = t.columns[c].numbers;
      const double at = right ? x + m.widths[c] - 0.5 * gap_between_cells : x + 0.5 * gap_between_cells;
      const TextStyle style{m.size, ink, right ? Anchor::end : Anchor::start, 0.0, bold, {}, m.widths[c] - 0.5 * gap_between_cells};
      if (c < texts.size()) draw([=, utf8 = texts[c]](Canvas& canvas) { canvas.text(at, y, utf8, style); });
      x += m.widths[c];
    }
  };
  const auto heads = [&] {
    draw([=, y = y_](Canvas& c) { c.fill(box_of(margin, y, width, head), shade); });
    for (size_t l = 0; l < m.head_lines; ++l) {
      std::vector<std::string> line;
      for (const auto& lines : m.heads) {  // heads end at the bottom
        const size_t above = m.head_lines - lines.size();
        line.push_back(l < above ? std::string() : lines[l - above]);
      }
      cells(line, y_ + step * (static_cast<double>(l) + 0.5), true);
    }
    y_ += head;
  };
  make_room(3.0 * leading * body_size + head + 2.0 * step);
  flow("Table " + std::to_string(++tables_) + ". " + t.caption, margin, 10.5, soft);
  heads();
  for (size_t r = 0; r < t.rows.size(); ++r) {
    const size_t sheet = sheets_.size();
    make_room(step);
    if (sheets_.size() != sheet) heads();
    if (r < t.tones.size() && t.tones[r] != Tone::plain)
      draw([=, y = y_, tone = t.tones[r]](Canvas& c) { c.fill(box_of(margin, y, width, step), back_of(tone)); });
    cells(t.rows[r], y_ + 0.5 * step, false);
    y_ += step;
    draw([=, y = y_](Canvas& c) { c.fill(box_of(margin, y - 1.0, width, 1.0), rule); });
  }
  y_ += 12.0;
}

void Paper::figure(const Drawing& d, const std::string& caption) {
  if (d.width <= 0 || d.height <= 0) return;
  const double scale = std::min({1.0, inner_width / d.width, figure_share * (bottom - margin) / d.height});
  make_room(scale * d.height + 3.0 * leading * 10.5);
  draw([=, y = y_](Canvas& c) { c.inset(margin, y, scale, d.paint); });
  y_ += scale * d.height + 4.0;
  flow("Figure " + std::to_string(++figures_) + ". " + caption, margin, 10.5, soft);
  y_ += 10.0;
}

void Paper::figure(core::Picture picture, const std::string& caption) {
  const auto kept = std::make_shared<core::Picture>(std::move(picture));
  figure({kept->width, kept->height,
          [kept](Canvas& c) {
            c.pixels({0, 0, kept->width, kept->height}, [&](int x, int y) {
              const std::uint8_t* p = kept->at(x, y);
              return core::Rgb{p[0], p[1], p[2]};
            });
          }},
         caption);
}

std::string Paper::pdf() const {
  std::vector<Drawing> pages;
  for (size_t k = 0; k < sheets_.size(); ++k)
    pages.push_back(
        {sheet_width, sheet_height, [this, k](Canvas& c) {
           for (const Ink& one : sheets_[k]) one(c);
           const double y = sheet_height - margin;
           c.text(margin, y, title_, {9.0, soft});
           c.text(sheet_width - margin, y, std::to_string(k + 1) + " / " + std::to_string(sheets_.size()), {9.0, soft, Anchor::end});
         }});
  return report::pdf(pages);
}

}  // namespace swath::report
