// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/page.h"

#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "core/error.h"
#include "report/chart.h"

namespace swath::report {
namespace {

bool holds(const std::string& text, const std::string& what) { return text.find(what) != std::string::npos; }

std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex r(pattern);
  std::vector<std::string> out;
  for (std::sregex_iterator it(text.begin(), text.end(), r), end; it != end; ++it) out.push_back((*it)[1]);
  return out;
}

Chart chart() {
  Chart c;
  Panel p;
  p.title = "a < b";
  p.series = {{"one", {0, 1, 2}, {0, 1, 0}, {}, Mark::line, 0}};
  c.panels = {p, p};
  return c;
}

Page full_page() {
  Page page("Report <1>", "Survey A & B");
  page.banner(Tone::caution, "Good \"enough\" <for now>");
  page.section("Values");
  page.paragraph("See" + page.footnote("A note & more") + " here.");
  page.section("Inner part", 3);
  page.list({"one", "two < three"});
  page.section("Values");
  page.table({"numbers", "Numbers", {{"name", false}, {"height (m)"}}, {{"a", "1.0"}, {"<b>"}}, {Tone::plain, Tone::bad}});
  page.figure_svg(svg(chart()), "A drawing", "figures/a.png");
  page.figure_svg(svg(chart()), "Another");
  page.figure_png("\x89PNG", "A picture" + page.footnote("of sorts"));
  return page;
}

TEST(Page, TextsAreEscapedEverywhere) {
  const std::string html = full_page().html();
  EXPECT_TRUE(holds(html, "<title>Report &lt;1&gt;</title>"));
  EXPECT_TRUE(holds(html, "<h1>Report &lt;1&gt;</h1>"));
  EXPECT_TRUE(holds(html, "Survey A &amp; B"));
  EXPECT_TRUE(holds(html, "id=\"verdict\">Good &quot;enough&quot; &lt;for now&gt;</p>"));
  EXPECT_TRUE(holds(html, "<li>two &lt; three</li>"));
  EXPECT_TRUE(holds(html, "<td>&lt;b&gt;</td>"));
  EXPECT_FALSE(holds(html, "<b>\""));
}

TEST(Page, NothingIsLoadedAndNothingRuns) {
  const std::string html = full_page().html();
  EXPECT_FALSE(holds(html, "<script"));
  EXPECT_FALSE(holds(html, "<link"));
  EXPECT_FALSE(holds(html, "@import"));
  for (const std::string& target : matches(html, "(?:src|href)=\"([^\"]*)\""))
    EXPECT_TRUE(target.starts_with("#") || target.starts_with("data:image/png;base64,")) << target;
  for (const std::string& target : matches(html, "url\\(([^)]*)\\)")) EXPECT_TRUE(target.starts_with("#")) << target;
}

TEST(Page, ContentsAndFootnotesLeadSomewhere) {
  const std::string html = full_page().html();
  const auto ids = matches(html, " id=\"([^\"]*)\"");
  const std::set<std::string> distinct(ids.begin(), ids.end());
  EXPECT_EQ(ids.size(), distinct.size()) << "an id stands twice";
  const auto links = matches(html, "<a href=\"#([^\"]*)\"");
  EXPECT_EQ(links.size(), 3u + 2u);
  for (const std::string& link : links) EXPECT_TRUE(distinct.contains(link)) << link;
  EXPECT_TRUE(distinct.contains("section-values") && distinct.contains("section-values-2"));
  EXPECT_TRUE(holds(html, "See<sup><a href=\"#note-1\">1</a></sup> here."));
  EXPECT_TRUE(holds(html, "<li id=\"note-1\">A note &amp; more</li>"));
}

TEST(Page, DrawingsShareNoNames) {
  const std::string html = full_page().html();
  const auto ids = matches(html, " id=\"(figure-[^\"]*)\"");
  const std::set<std::string> distinct(ids.begin(), ids.end());
  EXPECT_EQ(ids.size(), distinct.size());
  // Two panels each, and each panel clips by its own box; letters are drawn once and used.
  for (const char* figure : {"figure-1-", "figure-2-"}) {
    const auto clips = matches(html, "url\\(#(" + std::string(figure) + "[^)]*)\\)"),
               letters = matches(html, "xlink:href=\"#(" + std::string(figure) + "[^\"]*)\"");
    EXPECT_GE(clips.size(), 2u);
    EXPECT_GT(letters.size(), 10u);
    for (const auto& used : {clips, letters})
      for (const std::string& id : used) EXPECT_TRUE(distinct.contains(id)) << id;
  }
}

TEST(Page, TablesAndFiguresAreNumberedAndSet) {
  const std::string html = full_page().html();
  EXPECT_TRUE(holds(html, "<table id=\"numbers\">"));
  EXPECT_TRUE(holds(html, "<b>Table 1.</b> Numbers"));
  EXPECT_TRUE(holds(html, "<th class=\"n\" scope=\"col\">height (m)</th>"));
  EXPECT_TRUE(holds(html, "<tr class=\"bad\"><td>&lt;b&gt;</td><td class=\"n\"></td></tr>"));
  EXPECT_TRUE(holds(html, "<b>Figure 3.</b>"));
  EXPECT_TRUE(holds(html, "A drawing <code>figures/a.png</code>"));
  EXPECT_TRUE(holds(html, "<img alt=\"A picture\" src=\"data:image/png;base64,iVBORw==\">"));
}

TEST(Page, MarksOfFootnotesInTextsOfOthersDoNoHarm) {
  Page page("t");
  page.paragraph(
      "a\x01\"><b>\x02"
      "b\x01"
      "7");
  const std::string html = page.html();
  EXPECT_TRUE(holds(html, "<p>a&quot;&gt;&lt;b&gt; b")) << html.substr(html.find("<main>"));
  EXPECT_FALSE(holds(html, "\"><b>"));
}

TEST(Page, EmptyPartsLeaveNothingBehind) {
  const std::string html = Page("t").html();
  for (const char* part : {"<nav", "<footer", "subtitle\"", "verdict"}) EXPECT_FALSE(holds(html, part)) << part;
}

TEST(Page, ARowLongerThanItsTableIsRefused) {
  Page page("t");
  EXPECT_THROW(page.table({"", "c", {{"one"}}, {{"1", "2"}}, {}}), core::Error);
}

}  // namespace
}  // namespace swath::report
