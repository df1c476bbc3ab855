// SPDX-License-Identifier: GPL-3.0-or-later
// Fixes from raw GNSS observations by RTKLIB, with what the report says of its bases.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/config/result.h"
#include "io/gnss/rtklib_config.h"
#include "stages/once.h"
#include "trajectory/gnss_combine.h"

namespace swath::stages {

struct RtklibStageOptions : io::RtklibOptions {
  std::filesystem::path program{"rnx2rtkp"};
  core::Metres max_distance{50000.0};
  std::string bases = "nearest";
  double agreement = 5.0;
  core::Metres base_tolerance{50.0};
  core::Seconds time_limit{7200.0};
};

/// "nearest" is 1, "all" any number; 0 where the text is neither, nor a number above 0.
size_t number_of_bases(const std::string& text);

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

Given<core::GnssData, RtklibFindings> solve_baselines(const io::Survey& survey, const RtklibStageOptions& o, const Output& to,
                                                      core::Tally& tally);
void expect_rinex(const Context& context, const RtklibStageOptions& o);
std::vector<std::filesystem::path> rinex_files(const io::Survey& survey);
std::vector<std::string> rtklib_products(const RtklibStageOptions&);

}  // namespace swath::stages
