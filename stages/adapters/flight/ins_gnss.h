// SPDX-License-Identifier: GPL-3.0-or-later
// The trajectory of a flight from its IMU and GNSS records, with its report, plots and, where truth is known, its errors.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/option.h"
#include "io/survey/survey.h"
#include "stages/once.h"
#include "trajectory/ins/ins_gnss.h"

namespace swath::stages {

enum class PlotFormat { png, svg, pdf };

}  // namespace swath::stages

namespace swath::core {
template <>
struct Choices<stages::PlotFormat> {
  static constexpr std::array<std::string_view, 3> names{"png", "svg", "pdf"};
};
}  // namespace swath::core

namespace swath::stages {

struct InsGnssStageOptions : trajectory::InsGnssOptions {
  std::vector<PlotFormat> plots{PlotFormat::png, PlotFormat::svg};
};

template <class V>
void describe(InsGnssStageOptions& o, V& v) {
  describe(static_cast<trajectory::InsGnssOptions&>(o), v);
  v.option("plots", o.plots, "Formats of the plots in the folder plots; an empty list makes none.");
}

Given<trajectory::Trajectory, trajectory::InsFigures> smooth_flight(core::ImuData imu, const core::GnssData& gnss, const io::Survey& survey,
                                                                    const InsGnssStageOptions& o, const Output& to,
                                                                    const core::OnProgress& progress, core::Tally& tally);
void expect_imu_spec(const Context& context, const InsGnssStageOptions&);
std::vector<std::filesystem::path> true_trajectory(const io::Survey& survey);
std::vector<std::string> ins_gnss_products(const InsGnssStageOptions& o);

}  // namespace swath::stages
