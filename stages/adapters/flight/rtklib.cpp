// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/flight/rtklib.h"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "core/error.h"
#include "core/time.h"
#include "io/gnss/pos_writer.h"
#include "io/gnss/rtklib_baselines.h"
#include "io/text/process.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
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

}  // namespace

/// "nearest" is 1, "all" any number; 0 where the text is neither, nor a number above 0.
size_t number_of_bases(const std::string& text) {
  if (text == "nearest") return 1;
  if (text == "all") return std::numeric_limits<size_t>::max();
  if (text.empty() || text.size() > 3 || text.find_first_not_of("0123456789") != std::string::npos) return 0;
  return static_cast<size_t>(std::stoi(text));
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

}  // namespace swath::stages
