// SPDX-License-Identifier: GPL-3.0-or-later
// Fixes from raw GNSS observations by RTKLIB, with what the report says of its bases.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/config/result.h"
#include "core/error.h"
#include "core/time.h"
#include "io/gnss/pos_writer.h"
#include "io/gnss/rtklib_baselines.h"
#include "io/gnss/rtklib_config.h"
#include "io/text/process.h"
#include "stages/adapters/adapters.h"
#include "stages/once.h"
#include "trajectory/gnss_combine.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

struct RtklibStageOptions : io::RtklibOptions {
  std::filesystem::path program{"rnx2rtkp"};
  core::Metres max_distance{50000.0};
  std::string bases = "nearest";
  double agreement = 5.0;
  core::Metres base_tolerance{50.0};
  core::Seconds time_limit{7200.0};
};

/// "nearest" is 1, "all" any number; 0 where the text is neither, nor a number above 0.
size_t number_of_bases(const std::string& text) {
  if (text == "nearest") return 1;
  if (text == "all") return std::numeric_limits<size_t>::max();
  if (text.empty() || text.size() > 3 || text.find_first_not_of("0123456789") != std::string::npos) return 0;
  return static_cast<size_t>(std::stoi(text));
}

template <class V>
void describe(RtklibStageOptions& o, V& v) {
  v.option("program", o.program, "RTKLIB's program rnx2rtkp: a file, or a name looked up on PATH (Debian package rtklib).");
  v.option("max_distance", o.max_distance, core::above(0), "Farthest base from the rover's approximate position.");
  v.option("bases", o.bases, "Bases within max_distance that are used: \"nearest\", \"all\", or the number of the nearest, \"2\".");
  v.option("agreement", o.agreement, core::above(0),
           "Several bases: fixed solutions of one epoch within this many sigmas agree and are averaged.");
  v.option("base_tolerance", o.base_tolerance, core::above(0),
           "Farthest that a base's own code solution may lie from its stated position.");
  v.option("time_limit", o.time_limit, core::above(0), "Longest time for one run of rnx2rtkp, which is ended then.");
  describe(static_cast<io::RtklibOptions&>(o), v);
  v.check(number_of_bases(o.bases) > 0, "bases is \"nearest\", \"all\" or a number from \"1\"");
}

struct RoverFigures {
  std::uint64_t epochs = 0;
  double interval = 0.0;  ///< s
  std::string first, last, place_from{};
};

template <class V>
void describe(const RoverFigures& r, V& v) {
  v.result("epochs", r.epochs, "Epochs that the aircraft's receiver has recorded.");
  v.result("interval_s", r.interval, core::seconds(), "Usual step between them.");
  v.result("first", r.first, "UTC of the first.");
  v.result("last", r.last, "UTC of the last.");
  v.result("approximate_position_from", r.place_from, "Where the approximate position is from.");
}

struct BaseFigures {
  std::string name;
  double distance = 0.0;                            ///< m
  std::optional<std::string> not_used{}, failed{};  ///< why
  std::optional<double> overlap{}, code_off{};      ///< %, m
  trajectory::GnssAccount fixes{};
  std::optional<double> solved{}, nearest{}, farthest{};  ///< %, m, m
};

template <class V>
void describe(const BaseFigures& r, V& v) {
  using core::metres, core::percent;
  v.result("name", r.name, core::plain().in_summary(), "Name of the base.");
  v.result("distance_m", r.distance, metres(0).in_summary(), "Distance from the rover's approximate position.");
  v.result("not_used", r.not_used, "Why it is not used.");
  v.result("overlap_percent", r.overlap, percent(), "Share of the rover's time that it records.");
  v.result("code_solution_off_m", r.code_off, metres(1), "Distance of its own code solution from its stated position.");
  describe(r.fixes, v);
  v.result("rover_epochs_percent", r.solved, percent(), "Share of the rover's epochs with a fix.");
  v.result("nearest_m", r.nearest, metres(0), "Shortest baseline.");
  v.result("farthest_m", r.farthest, metres(0), "Longest baseline.");
  v.result("failed", r.failed, "Why it has no solution.");
}

struct BaseShare {
  std::string name;
  std::uint64_t epochs = 0;
};

template <class V>
void describe(const BaseShare& r, V& v) {
  v.result("name", r.name, "Name of the base.");
  v.result("epochs", r.epochs, "Epochs at which its fix is taken, or is the first of those averaged.");
}

struct CombinedFigures {
  trajectory::GnssAccount fixes{};
  std::uint64_t averaged = 0, disagreeing = 0;
  std::vector<BaseShare> taken{};
  double worst_disagreement = 0.0;  ///< m
};

template <class V>
void describe(const CombinedFigures& r, V& v) {
  describe(r.fixes, v);
  v.result("averaged", r.averaged, "Epochs that are means of several fixed solutions.");
  v.result("disagreeing", r.disagreeing, "Epochs at which fixed solutions disagree.");
  v.tables("taken", r.taken, "Epochs by base.");
  v.result("worst_disagreement_m", r.worst_disagreement, core::metres().only_if(r.disagreeing > 0), "Largest distance of two of those.");
}

struct RtklibFindings {
  RoverFigures rover{};
  std::vector<BaseFigures> bases{};
  std::optional<CombinedFigures> combined{};
  trajectory::GnssAccount fixes{};
};

template <class V>
void describe(const RtklibFindings& r, V& v) {
  v.table("rover", r.rover, "The aircraft's receiver.");
  v.tables("bases", r.bases, "Base stations, those that are not used first.");
  v.table("combined", r.combined, "Several bases as one.");
  v.result("epochs", r.fixes.fixes, core::plain().in_summary(), "Epochs with a fix.");
  v.result("fixed_percent", 100 * r.fixes.share(core::FixQuality::fixed), core::percent().in_summary(), "Share of them that is fixed.");
  v.result("longest_gap_s", r.fixes.longest_gap, core::seconds(1).in_summary(), "Longest step between fixes.");
}

using core::FixQuality;

constexpr double low_share_of_fixed = 0.5;  // below, the report warns
constexpr double complete = 0.999;          // of the rover's epochs or of its span, above which nothing is missing
constexpr const char* folder_name = "gnss";

std::string fixed_text(double value, int digits) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

void judge(const io::Base& b, const io::Receiver& rover, const core::GnssData& fixes, BaseFigures& one, core::Tally& tally) {
  const trajectory::GnssAccount a = one.fixes = trajectory::account_of(fixes, rover.interval);
  const double solved = static_cast<double>(a.fixes) / static_cast<double>(rover.epochs);
  one.solved = 100 * solved;
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  for (const Eigen::Vector3d& p : fixes.position) {
    const double d = (p - b.position).norm();
    nearest = std::min(nearest, d);
    farthest = std::max(farthest, d);
  }
  one.nearest = nearest;
  one.farthest = farthest;
  if (b.share_of(rover) < complete)
    tally.count("base that does not record over the whole flight", b.name + ": " + fixed_text(100 * b.share_of(rover), 1) + " % of it");
  if (solved < complete)
    tally.count("epochs of the rover without a solution",
                b.name + ": longest gap " + fixed_text(a.longest_gap, 1) + " s from " + core::utc_text(a.longest_gap_at),
                rover.epochs - std::min<std::uint64_t>(a.fixes, rover.epochs));
  if (a.share(FixQuality::fixed) < low_share_of_fixed)
    tally.count("base with fewer than half of the epochs fixed", b.name + ": " + fixed_text(100 * a.share(FixQuality::fixed), 1) + " %");
}

/// Several solutions as one, which is written, too.
core::GnssData combine(const std::vector<core::GnssData>& solutions, const std::vector<BaseShare>& bases, double agreement, double interval,
                       const fs::path& file, CombinedFigures& found, core::Tally& tally) {
  trajectory::CombinedGnss all = trajectory::combine_gnss(solutions, agreement);
  found = {trajectory::account_of(all.data, interval), all.averaged, all.disagreeing, bases, all.worst_disagreement};
  std::string of = "solutions of several bases as one:";
  for (size_t i = 0; i < bases.size(); ++i) {
    found.taken[i].epochs = all.taken[i];
    of += " " + bases[i].name;
  }
  if (all.disagreeing)
    tally.count("epochs at which fixed solutions of several bases disagree",
                fixed_text(all.worst_disagreement, 3) + " m at " + core::utc_text(all.worst_at), all.disagreeing);
  io::write_pos(file, all.data, {of});
  return std::move(all.data);
}

std::vector<std::string> rtklib_products(const RtklibStageOptions&) { return {folder_name}; }

std::vector<fs::path> rinex_files(const io::Survey& survey) {
  std::vector<fs::path> out;
  const auto add = [&](const std::vector<fs::path>& files) {
    for (const fs::path& f : files) out.push_back(io::resolve(survey, f));
  };
  add(survey.rinex.rover);
  add(survey.rinex.navigation);
  for (const io::BaseStation& b : survey.rinex.bases) add(b.observations);
  if (survey.rinex.antenna_file) add({*survey.rinex.antenna_file});
  return out;
}

void expect_rinex(const Context& context, const RtklibStageOptions& o) {
  const io::Rinex& r = context.survey.rinex;
  const auto refuse = [&](const std::string& what, const std::string& hint) {
    throw core::usage_error("gnss.rtklib: " + what, context.survey.name, hint);
  };
  if (r.rover.empty()) refuse("the survey names no rover in [rinex]", "name the aircraft's RINEX observation files: rover = [\"...\"]");
  if (r.navigation.empty()) refuse("the survey names no navigation files in [rinex]", "name RINEX navigation files of the day");
  if (r.bases.empty()) refuse("the survey names no [[rinex.base]]", "differential GNSS needs a base station, at best within 20 km");
  for (const io::BaseStation& b : r.bases)
    if (b.observations.empty()) refuse("the base '" + b.name + "' has no observations", "name its RINEX observation files");
  bool antennas = !r.antenna_type.empty();
  for (const io::BaseStation& b : r.bases) antennas = antennas || !b.antenna_type.empty();
  if (antennas && !r.antenna_file)
    refuse("antenna types are stated, but no antenna_file", "name an ANTEX file in [rinex], or leave the types out");
  if (io::find_program(o.program).empty())
    refuse("the program '" + o.program.string() + "' is not found",
           "install RTKLIB (Debian and Ubuntu: apt-get install rtklib), or name the program: program = \"/path/of/rnx2rtkp\"");
}

Given<core::GnssData, RtklibFindings> solve_baselines(const io::Survey& survey, const RtklibStageOptions& o, const Output& to,
                                                      core::Tally& tally) {
  io::RtklibJob job;
  job.program = io::find_program(o.program);
  job.products = to.folder / folder_name;
  job.options = o;
  job.time_limit = o.time_limit.value;
  const io::Receiver rover = io::scan_receiver(survey, survey.rinex.rover);
  job.rover = rover.files;
  io::share_files(survey, rover, job, tally);
  RtklibFindings found;
  found.rover = {rover.epochs, rover.interval, core::utc_text(rover.first), core::utc_text(rover.last)};
  const Eigen::Vector3d place = io::approximate_place(rover, job, found.rover.place_from);
  const std::vector<io::Base> bases = io::read_bases(survey, rover, place, tally);
  const std::vector<std::string> reasons = io::reasons_against(bases, rover, o.max_distance.value, number_of_bases(o.bases));
  for (size_t i = 0; i < bases.size(); ++i)
    if (!reasons[i].empty()) found.bases.push_back({bases[i].name, bases[i].distance, reasons[i]});

  std::vector<core::GnssData> solutions;
  std::vector<BaseShare> solved;
  std::optional<core::Error> failure;
  for (size_t i = 0; i < bases.size(); ++i) {
    if (!reasons[i].empty()) continue;
    const io::Base& b = bases[i];
    BaseFigures& one = found.bases.emplace_back(BaseFigures{b.name, b.distance});
    one.overlap = 100 * b.share_of(rover);
    one.code_off = io::distance_by_code(b, job, o.base_tolerance.value, tally);
    try {
      solutions.push_back(io::solve(b, job, tally));
      solved.push_back({b.name});
      judge(b, rover, solutions.back(), one, tally);
    } catch (const core::SystemError&) {
      throw;
    } catch (const core::Error& e) {
      if (!failure) failure = e;
      one.failed = e.text();
      tally.count("bases without a solution", b.name + ": " + e.what());
    }
  }
  if (solutions.empty()) throw *failure;
  core::GnssData out = solutions.size() == 1 ? std::move(solutions.front())
                                             : combine(solutions, solved, o.agreement, rover.interval, job.products / "combined.pos",
                                                       found.combined.emplace(), tally);
  found.fixes = trajectory::account_of(out, rover.interval);
  for (double& t : out.time) t += survey.antenna.latency.value;
  return {std::move(out), std::move(found)};
}

}  // namespace

Entry rtklib_stage() {
  return once<solve_baselines>("gnss.rtklib",
                               "Antenna positions from raw GNSS observations of the aircraft and of base stations, by RTKLIB's rnx2rtkp.",
                               {.check = expect_rinex, .inputs = rinex_files, .products = rtklib_products});
}

}  // namespace swath::stages
