// SPDX-License-Identifier: GPL-3.0-or-later
// Blocks of images: their accuracy before the flight, their stations against a reference after it.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>

#include "calib/block/block_files.h"
#include "calib/block/block_theory.h"
#include "calib/block/checks/checked_adjustment.h"
#include "calib/block/station_drift.h"
#include "core/config/option_visitors.h"
#include "core/config/result_visitors.h"
#include "core/error.h"
#include "io/survey/tree_kind.h"
#include "io/text/delimited.h"
#include "io/text/text_table.h"
#include "io/text/value_file.h"
#include "pipeline/input_guard.h"
#include "pipeline/jobs/set_options.h"
#include "tools/command.h"

namespace swath::tools {
namespace {

struct TheoryArguments {
  std::string config;
  std::vector<std::string> sets;
  bool json = false;
};

calib::TheoryOptions theory_options(core::Value given, const std::vector<std::string>& sets) {
  for (const std::string& set : sets) pipeline::set_option(given, set);
  calib::TheoryOptions options;
  std::vector<core::Fault> faults;
  core::read_options(core::described(options), given, "", faults);
  core::throw_if_any(faults);
  return options;
}

int block_theory(const TheoryArguments& a) {
  const calib::TheoryOptions options = theory_options(a.config.empty() ? core::Value::object() : io::read_value_file(a.config), a.sets);
  const calib::TheoryTable table = calib::theory_table(options);
  a.json ? print_json(core::reported(table)) : print(calib::theory_text(table));
  return 0;
}

struct DriftArguments {
  std::string file;
  std::vector<std::string> columns;
  bool json = false;
};

/// Columns of numbers of a table that are not its strip and time.
std::vector<std::string> difference_columns(const std::filesystem::path& file) {
  std::vector<std::string> out;
  for (const std::string& name : io::inspect_delimited(file).names)
    if (name != "strip" && name != "time") out.push_back(name);
  if (out.empty())
    throw core::Error("the table has no column of differences", file.string(), "columns: strip, time, and one per coordinate");
  return out;
}

std::vector<calib::StripDifferences> differences_of(const io::TextTable& table, const std::string& column) {
  const size_t strip = table.column("strip"), time = table.column("time"), difference = table.column(column);
  std::vector<calib::StripDifferences> out;
  std::map<std::string, size_t> number;
  for (size_t r = 0; r < table.rows(); ++r) {
    const auto [it, is_new] = number.try_emplace(table.text(r, strip), out.size());
    if (is_new) out.push_back({it->first, {}, {}});
    out[it->second].time.push_back(table.number(r, time));
    out[it->second].difference.push_back(table.number(r, difference));
  }
  return out;
}

std::string drift_text(const calib::DriftFound& f) {
  char line[240];
  std::snprintf(line, sizeof line, "%s: rms %.4f, less each strip's mean %.4f, less one line %.4f, less each strip's line %.4f\n",
                f.coordinate.c_str(), f.together.direct, f.together.less_mean, f.together.less_line, f.less_lines);
  std::string out = line;
  std::snprintf(line, sizeof line, "  one line through all: %.4f %+.6f per s\n", f.together.a0, f.together.a1);
  out += line;
  for (const calib::DriftLine& s : f.strips) {
    std::snprintf(line, sizeof line, "  strip %-8s %5zu stations: rms %.4f, less mean %.4f, less line %.4f; line %.4f %+.6f per s\n",
                  s.strip.c_str(), s.stations, s.direct, s.less_mean, s.less_line, s.a0, s.a1);
    out += line;
  }
  return out;
}

int block_drift(const DriftArguments& a) {
  const io::TextTable table(a.file);
  core::Value list = core::Value::array();
  for (const std::string& column : a.columns.empty() ? difference_columns(a.file) : a.columns) {
    const calib::DriftFound found = calib::drift_of(column, differences_of(table, column));
    if (a.json)
      list.push(core::reported(found));
    else
      print(drift_text(found));
  }
  if (a.json) print_json(list);
  return 0;
}

struct BlockArguments {
  std::string config;
  std::filesystem::path folder = "block";
  std::vector<std::string> sets;
  bool quiet = false, json = false;
};

/// No product takes the place of what the block is read from: its config may be a block.json, its points in a folder colmap.
void expect_apart(const BlockArguments& a, const calib::BlockConfig& config) {
  std::vector<std::filesystem::path> read{a.config, config.images.file, config.images.correlation};
  for (const auto& f : config.image_points) read.push_back(f.file);
  for (const auto& f : config.control) read.push_back(f.file);
  std::erase(read, std::filesystem::path());
  const pipeline::InputGuard guard(read);
  for (const std::string& product : calib::block_products()) guard.expect_apart(a.folder / product);
}

int block(const BlockArguments& a) {
  core::Value given = io::read_value_file(a.config);
  io::require_kind(given, io::TreeKind::block, a.config);
  for (const std::string& set : a.sets) pipeline::set_option(given, set);
  const calib::BlockConfig config = calib::read_block_config(a.config, given);
  expect_apart(a, config);
  calib::ReadBlock read = calib::read_block(config, a.config);
  const calib::CheckedAdjustment adjusted = calib::adjust_checked(read, config);
  const calib::BlockFound& found = adjusted.found;
  const std::vector<std::string> files = calib::write_block(a.folder, read, config, adjusted.solution, found);
  if (a.json) {
    print_json(core::reported(found));
  } else if (!a.quiet) {
    print(calib::block_text(found));
    std::string text = "written to " + a.folder.string() + ":";
    for (const std::string& f : files) text += " " + f;
    print(text + "\n");
  }
  return 0;
}

}  // namespace

void add_block_command(Commands& commands) {
  const auto a = std::make_shared<BlockArguments>();
  auto* c = commands.add("block",
                         "Examples\n  swath block block.toml --output block\n\nAdjust a block of images with GNSS stations, "
                         "control and self-calibration.",
                         [a] { return block(*a); });
  c->add_option("CONFIG", a->config, "Cameras, images, image points and control, .toml or .json")->required();
  add_output(*c, a->folder, "Folder for orientations, cameras, points and report; default: block");
  c->add_option("--set", a->sets, "One option of it: drift=strip, adjust.robust=false")->allow_extra_args(false);
  add_quiet(*c, a->quiet);
  c->add_flag("--json", a->json, "What block.json holds, on the terminal");
}

void add_block_theory_command(Commands& commands) {
  const auto a = std::make_shared<TheoryArguments>();
  auto* c =
      commands.add("block-theory",
                   "Examples\n  swath block-theory\n  swath block-theory configs/flight/block_theory.toml --set strips=10 --json\n\nShow "
                   "the accuracy of a block of images with GNSS stations before it is flown.",
                   [a] { return block_theory(*a); });
  c->add_option("THEORY", a->config, "What the block is like, .toml or .json; without it Ackermann's block");
  c->add_option("--set", a->sets, "One option of it: scale=20000, sigma_station=\"5 cm\"")->allow_extra_args(false);
  c->add_flag("--json", a->json, "As JSON");
}

void add_block_drift_command(Commands& commands) {
  const auto a = std::make_shared<DriftArguments>();
  auto* c = commands.add("block-drift",
                         "Examples\n  swath block-drift differences.csv\n  swath block-drift differences.csv --column dx "
                         "--json\n\nShow shift and drift of stations against a reference, strip by strip.",
                         [a] { return block_drift(*a); });
  c->add_option("FILE", a->file, "Table: strip, time in s, and columns of differences station less reference")->required();
  c->add_option("--column", a->columns, "Column of differences; may be given more than once; default: all")->allow_extra_args(false);
  c->add_flag("--json", a->json, "As JSON");
}

std::optional<std::string> check_block_config(const std::filesystem::path& config, const std::vector<std::string>& sets) {
  if (!std::filesystem::is_regular_file(config)) return std::nullopt;
  core::Value given = io::read_value_file(config);
  if (given.find("stage") || given.find("run")) return std::nullopt;
  if (given.find("image_points")) {
    for (const std::string& set : sets) pipeline::set_option(given, set);
    return "a block of images, " + core::counted(calib::read_block_config(config.string(), given).image_points.size(), "file") +
           " of image points";
  }
  if (!given.find("sigma_image")) return std::nullopt;
  const calib::TheoryOptions options = theory_options(given, sets);
  return "the accuracy of a block of " + core::counted(options.strips, "strip") + " of " + core::counted(options.images, "image");
}

}  // namespace swath::tools
