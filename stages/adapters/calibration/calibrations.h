// SPDX-License-Identifier: GPL-3.0-or-later
// The calibrations of a flight by its laser: rigorous adjustment on planes, and a flat roof.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "calib/adjust/calibrate.h"
#include "calib/report/flat_target_report.h"
#include "calib/target/flat_target.h"
#include "core/config/option.h"
#include "core/config/result.h"
#include "stages/adapters/calibration/calibration_flight.h"
#include "stages/once.h"
#include "trajectory/ins/error_model.h"

namespace swath::stages {

struct AdjustStageOptions : calib::CalibrateOptions, FlightStageOptions {};

template <class V>
void describe(AdjustStageOptions& o, V& v) {
  describe(static_cast<calib::CalibrateOptions&>(o), v);
  describe(static_cast<FlightStageOptions&>(o), v);
}

struct EstimateResult {
  double value = 0.0, sigma = 0.0, start = 0.0;
  bool delivered = false;
  std::string grade;
};

template <class V>
void describe(const EstimateResult& r, V& v) {
  const core::Form si = core::Form{"SI"}.always();
  v.result("value", r.value, si, "Estimate, in rad, m or as a ratio.");
  v.result("sigma", r.sigma, si, "Its standard deviation.");
  v.result("start", r.start, si, "Value in the survey.");
  v.result("delivered", r.delivered, "True: it is written into calibration.json.");
  v.result("grade", r.grade, "How well the flight determines it.");
}

struct AdjustFindings {
  std::vector<std::pair<std::string, EstimateResult>> estimates{};
  std::uint64_t planes = 0, tie_returns = 0;
  int rounds = 0;
  double sigma0 = 0.0;
  std::vector<std::string> findings{};
};

template <class V>
void describe(const AdjustFindings& r, V& v) {
  v.named_tables("estimates", r.estimates, "Estimates by parameter.");
  v.result("planes", r.planes, core::plain().in_summary(), "Planes that several lines have seen.");
  v.result("tie_returns", r.tie_returns, core::plain().in_summary(), "Returns on these planes.");
  v.result("rounds", r.rounds, "Rounds of the adjustment.");
  v.result("sigma0", r.sigma0, core::plain(3).in_summary().always(), "A posteriori sigma of unit weight.");
  v.result("findings", r.findings, core::plain().in_summary(), "What the adjustment found, as sentences.");
}

AdjustFindings adjust_flight(const Context& context, const trajectory::Trajectory& trajectory, const georef::ShotStream& shots,
                             const AdjustStageOptions& o, const Output& to, const core::OnProgress& progress, core::Tally& tally);
std::vector<std::string> adjust_products(const AdjustStageOptions&);

struct FlatTargetStageOptions : calib::FlatTargetOptions {
  trajectory::ErrorModelOptions errors;
};

template <class V>
void describe(FlatTargetStageOptions& o, V& v) {
  describe(static_cast<calib::FlatTargetOptions&>(o), v);
  v.table("errors", o.errors, "Errors of trajectories that state no covariances between instants.");
}

calib::FlatTarget measure_flat_target(const io::Survey& survey, const trajectory::Trajectory& trajectory, const georef::ShotStream& shots,
                                      const FlatTargetStageOptions& o, const Output& to, core::Tally& tally);
std::vector<std::string> flat_target_products(const FlatTargetStageOptions&);

}  // namespace swath::stages
