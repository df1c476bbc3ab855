// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/page.h"

#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "report/html.h"

namespace swath::report {
namespace {

/// Marks of a footnote within a text; they occur in no text of a person.
constexpr char note_begin = '\x01', note_end = '\x02';

constexpr std::string_view style = R"(
:root{color-scheme:light dark;--ink:#1c2126;--soft:#59636e;--paper:#ffffff;--rule:#d3d9df;--shade:#f4f6f8;--link:#0b5cad;
--good:#14713f;--good-back:#e9f6ee;--caution:#8a5a00;--caution-back:#fff6e0;--bad:#ad1f15;--bad-back:#fdeceb}
@media (prefers-color-scheme:dark){:root{--ink:#e3e7eb;--soft:#9aa5b1;--paper:#15191d;--rule:#38414a;--shade:#1f252b;--link:#7db8f5;
--good:#6fd29b;--good-back:#14301f;--caution:#f0c060;--caution-back:#352a10;--bad:#ff9a90;--bad-back:#3c1a17}}
*{box-sizing:border-box}
body{margin:0 auto;padding:2rem 1.5rem 4rem;max-width:76rem;background:var(--paper);color:var(--ink);
font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans","DejaVu Sans",sans-serif}
h1{font-size:1.9rem;line-height:1.2;margin:0 0 .25rem}
h2{font-size:1.35rem;line-height:1.25;margin:2.75rem 0 .75rem;padding-bottom:.3rem;border-bottom:1px solid var(--rule)}
h3{font-size:1.08rem;margin:1.75rem 0 .5rem}
p,li{max-width:52rem}
p{margin:.6rem 0}
a{color:var(--link)}
.subtitle{color:var(--soft);margin:0}
.banner{margin:1.25rem 0;padding:.9rem 1.1rem;border-left:.4rem solid var(--soft);background:var(--shade);font-size:1.1rem;max-width:none}
.banner.good{border-color:var(--good);background:var(--good-back)}
.banner.caution{border-color:var(--caution);background:var(--caution-back)}
.banner.bad{border-color:var(--bad);background:var(--bad-back)}
nav{margin:1.25rem 0;padding:.75rem 1.1rem;background:var(--shade)}
nav ol{margin:0;padding:0;list-style:none;columns:16rem;column-gap:2rem}
nav li{break-inside:avoid}
nav li.inner{padding-left:1.25rem;font-size:.92em}
nav a{text-decoration:none}
nav a:hover{text-decoration:underline}
.table{margin:1rem 0 1.5rem;overflow-x:auto}
table{border-collapse:collapse;font-size:.92rem}
caption{text-align:left;padding:0 0 .4rem;color:var(--soft);font-size:.92rem}
caption b,figcaption b{color:var(--ink)}
th,td{padding:.28rem .75rem;border-bottom:1px solid var(--rule);text-align:left;vertical-align:baseline}
th{vertical-align:bottom;font-weight:600;background:var(--shade);line-height:1.25}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}
td.n{white-space:nowrap}
tr.good td:first-child{box-shadow:inset .25rem 0 var(--good)}
tr.caution td{background:var(--caution-back)}
tr.bad td{background:var(--bad-back)}
figure{margin:1.25rem 0 1.75rem}
figure>svg,figure>img{display:block;max-width:100%;height:auto;background:#fff;border:1px solid var(--rule)}
figcaption{margin-top:.4rem;color:var(--soft);font-size:.92rem;max-width:52rem}
code{font-family:ui-monospace,"DejaVu Sans Mono",monospace;font-size:.9em}
sup a{text-decoration:none}
.notes{margin-top:3rem;padding-top:.5rem;border-top:1px solid var(--rule);font-size:.88rem;color:var(--soft)}
.notes ol{padding-left:1.5rem}
@media print{:root{font-size:9.5pt;color-scheme:light;--ink:#000;--soft:#444;--paper:#fff;--rule:#bbb;--shade:#f4f6f8;--link:#000}
@page{margin:15mm}
body{max-width:none;padding:0;font-size:1rem}
table{font-size:.8rem}
th,td{padding:.2rem .4rem}
nav{display:none}
h2,h3{break-after:avoid}
figure,tr,.banner{break-inside:avoid}
thead{display:table-header-group}
.table{overflow:visible}
.banner,th,td{print-color-adjust:exact;-webkit-print-color-adjust:exact}}
)";

std::string_view name_of(Tone tone) {
  switch (tone) {
    case Tone::good:
      return "good";
    case Tone::caution:
      return "caution";
    case Tone::bad:
      return "bad";
    case Tone::plain:
      break;
  }
  return "plain";
}

/// Every id of a drawing and every url(#id) that points to it with `prefix` before it: two drawings on one page share no names.
std::string with_own_ids(std::string_view svg, const std::string& prefix) {
  std::string out;
  for (size_t at = 0; at < svg.size();) {
    size_t next = std::string_view::npos, length = 0;
    for (const std::string_view mark : {std::string_view(" id=\""), std::string_view("url(#"), std::string_view("href=\"#")}) {
      const size_t found = svg.find(mark, at);
      if (found < next) {
        next = found;
        length = mark.size();
      }
    }
    if (next == std::string_view::npos) return out.append(svg.substr(at));
    out.append(svg.substr(at, next + length - at)).append(prefix);
    at = next + length;
  }
  return out;
}

}  // namespace

Table value_table(const std::string& caption, const std::vector<std::pair<std::string, std::string>>& rows) {
  Table t;
  t.caption = caption;
  t.columns = {{"", false}, {"value"}};
  for (const auto& [name, value] : rows) t.rows.push_back({name, value});
  return t;
}

Page::Page(std::string title, std::string subtitle) : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

std::string Page::inline_html(std::string_view text) const {
  std::string out;
  while (!text.empty()) {
    const size_t begin = std::min(text.find(note_begin), text.size()), end = std::min(text.find(note_end, begin), text.size());
    out += escaped(text.substr(0, begin));
    if (begin == text.size()) break;
    const std::string_view inside = text.substr(begin + 1, end - begin - 1);
    const bool number = !inside.empty() && std::all_of(inside.begin(), inside.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (number) out.append("<sup><a href=\"#note-").append(inside).append("\">").append(inside).append("</a></sup>");
    text.remove_prefix(number ? std::min(end + 1, text.size()) : begin + 1);
  }
  return out;
}

std::string Page::unique_id(std::string_view heading) const {
  std::string id;
  for (const char c : heading) {
    const auto u = static_cast<unsigned char>(c);
    if (u < 0x80 && std::isalnum(u))
      id += static_cast<char>(std::tolower(u));
    else if (!id.empty() && id.back() != '-')
      id += '-';
  }
  while (!id.empty() && id.back() == '-') id.pop_back();
  id = "section-" + id;
  const auto taken = [this](const std::string& name) {
    return std::any_of(contents_.begin(), contents_.end(), [&](const Entry& e) { return e.id == name; });
  };
  std::string out = id;
  for (int n = 2; taken(out); ++n) out = id + "-" + std::to_string(n);
  return out;
}

void Page::banner(Tone tone, std::string text) {
  tone_ = tone;
  verdict_ = std::move(text);
}

void Page::section(const std::string& heading, int level) {
  const std::string tag = level <= 2 ? "h2" : "h3";
  contents_.push_back({level, unique_id(heading), heading});
  body_ += "<" + tag + " id=\"" + contents_.back().id + "\">" + inline_html(heading) + "</" + tag + ">\n";
}

void Page::paragraph(const std::string& text) { body_ += "<p>" + inline_html(text) + "</p>\n"; }

void Page::list(const std::vector<std::string>& items) {
  body_ += "<ul>\n";
  for (const std::string& item : items) body_ += "<li>" + inline_html(item) + "</li>\n";
  body_ += "</ul>\n";
}

void Page::table(const Table& t) {
  body_ += "<div class=\"table\"><table";
  if (!t.id.empty()) body_ += " id=\"" + escaped(t.id) + "\"";
  body_ += ">\n<caption><b>Table " + std::to_string(++tables_) + ".</b> " + inline_html(t.caption) + "</caption>\n<thead><tr>";
  for (const Column& c : t.columns)
    body_ += std::string(c.numbers ? "<th class=\"n\"" : "<th") + " scope=\"col\">" + inline_html(c.head) + "</th>";
  body_ += "</tr></thead>\n<tbody>\n";
  for (size_t r = 0; r < t.rows.size(); ++r) {
    if (t.rows[r].size() > t.columns.size())
      throw core::Error("a row of a table has more cells than the table has columns", t.caption, "this is a fault of the program");
    const Tone tone = r < t.tones.size() ? t.tones[r] : Tone::plain;
    body_ += tone == Tone::plain ? "<tr>" : "<tr class=\"" + std::string(name_of(tone)) + "\">";
    for (size_t c = 0; c < t.columns.size(); ++c)
      body_ += (t.columns[c].numbers ? "<td class=\"n\">" : "<td>") + (c < t.rows[r].size() ? inline_html(t.rows[r][c]) : std::string()) +
               "</td>";
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
}

void Page::figure(const std::string& what, const std::string& caption, const std::string& file) {
  body_ += "<figure>\n" + what + "<figcaption><b>Figure " + std::to_string(++figures_) + ".</b> " + inline_html(caption);
  if (!file.empty()) body_ += " <code>" + escaped(file) + "</code>";
  body_ += "</figcaption>\n</figure>\n";
}

void Page::figure_svg(std::string_view svg, const std::string& caption, const std::string& file) {
  figure(with_own_ids(svg, "figure-" + std::to_string(figures_ + 1) + "-"), caption, file);
}

void Page::figure_png(std::string_view png, const std::string& caption, const std::string& file) {
  // A reader without pictures gets the caption, without the marks of footnotes.
  std::string plain;
  bool inside = false;
  for (const char c : caption) {
    inside = inside || c == note_begin;
    if (!inside) plain += c;
    inside = inside && c != note_end;
  }
  figure("<img alt=\"" + escaped(plain) + "\" src=\"data:image/png;base64," + base64(png) + "\">\n", caption, file);
}

std::string Page::footnote(const std::string& text) {
  footnotes_.push_back(text);
  return note_begin + std::to_string(footnotes_.size()) + note_end;
}

std::string Page::html() const {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'\">\n<title>" +
      escaped(title_) + "</title>\n<style>" + std::string(style) + "</style>\n</head>\n<body>\n<header>\n<h1>" + inline_html(title_) +
      "</h1>\n";
  if (!subtitle_.empty()) out += "<p class=\"subtitle\">" + inline_html(subtitle_) + "</p>\n";
  if (!verdict_.empty())
    out += "<p class=\"banner " + std::string(name_of(tone_)) + "\" id=\"verdict\">" + inline_html(verdict_) + "</p>\n";
  out += "</header>\n";
  if (!contents_.empty()) {
    out += "<nav aria-label=\"Contents\"><ol>\n";
    for (const Entry& e : contents_)
      out += std::string(e.level <= 2 ? "<li>" : "<li class=\"inner\">") + "<a href=\"#" + e.id + "\">" + inline_html(e.heading) +
             "</a></li>\n";
    out += "</ol></nav>\n";
  }
  out += "<main>\n" + body_ + "</main>\n";
  if (!footnotes_.empty()) {
    out += "<footer class=\"notes\"><ol>\n";
    for (size_t n = 0; n < footnotes_.size(); ++n)
      out += "<li id=\"note-" + std::to_string(n + 1) + "\">" + inline_html(footnotes_[n]) + "</li>\n";
    out += "</ol></footer>\n";
  }
  return out + "</body>\n</html>\n";
}

}  // namespace swath::report
