// SPDX-License-Identifier: GPL-3.0-or-later
// swath(1) in the macros of man(7).
#include "tools/command_docs.h"

namespace swath::tools {
namespace {

/// Text with what roff would take for its own escaped: backslashes, hyphens that are typed, lines that begin with a dot or a quote.
std::string roff(const std::string& text) {
  std::string out;
  for (size_t k = 0; k < text.size(); ++k) {
    const bool begins = k == 0 || text[k - 1] == '\n';
    if (begins && (text[k] == '.' || text[k] == '\'')) out += "\\&";
    if (text[k] == '\\')
      out += "\\e";
    else if (text[k] == '-')
      out += "\\-";
    else
      out += text[k];
  }
  return out;
}

std::string section(const std::string& name) { return ".SH " + name + "\n"; }
std::string entry(const std::string& head, const std::string& text) { return ".TP\n.B " + roff(head) + "\n" + roff(text) + "\n"; }

std::string head_of(const OptionText& o) {
  std::string out;
  for (const std::string& name : o.names) out += (out.empty() ? "" : ", ") + name;
  return out + (o.takes_value && !o.positional ? " VALUE" : "") + (o.positional && o.is_repeated ? " ..." : "");
}

std::string usage_of(const CommandText& c) {
  std::string out = "swath " + c.name;
  for (const OptionText& o : c.options)
    if (o.positional)
      out += " " + std::string(o.is_required ? "" : "[") + o.names.front() + (o.is_repeated ? "..." : "") + (o.is_required ? "" : "]");
  return out + " [options]";
}

}  // namespace

std::string manual_page(const std::vector<CommandText>& commands, const std::string& version, const std::string& footer) {
  std::string out = ".TH SWATH 1 \"\" \"swath " + version + "\" \"User commands\"\n";
  out += section("NAME") + "swath \\- raw records of an airborne laser survey to points, terrain model and contours\n";
  out += section("SYNOPSIS") + ".B swath\n.I COMMAND\n[options]\n";
  out += section("DESCRIPTION") +
         "Takes the raw records of an airborne laser survey (ranges, scan angles, IMU, GNSS) to georeferenced, classified point\n"
         "clouds, terrain models and contours, and says how good each of them is.\n";
  out += section("COMMANDS");
  for (const CommandText& c : commands) {
    out += ".SS " + roff(usage_of(c)) + "\n" + roff(c.sentence) + "\n";
    for (const OptionText& o : c.options) out += entry(head_of(o), o.help);
    if (!c.examples.empty()) out += ".PP\nExamples:\n.PP\n.nf\n" + roff(c.examples) + "\n.fi\n";
  }
  out += section("ENVIRONMENT") +
         entry("SWATH_CONFIGS", "A folder of configs that are found by their names, searched before those of the program.") +
         entry("SOURCE_DATE_EPOCH", "Seconds since 1970 that stand in for the present day in the headers of products.") +
         entry("PROJ_DATA", "Folders of PROJ's database and grids.");
  return out + section("EXIT STATUS") + roff(footer) + "\n";
}

}  // namespace swath::tools
