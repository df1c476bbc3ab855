// SPDX-License-Identifier: GPL-3.0-or-later
// IMU, GNSS and laser surfaces of a survey in one adjustment.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "calib/adjust/parameter_words.h"
#include "calib/adjust/prepared_flight.h"
#include "calib/adjust/start_sigmas.h"
#include "calib/network/network_adjust.h"
#include "calib/network/network_report.h"
#include "calib/report/calibration_report.h"
#include "calib/report/flight_views.h"
#include "core/config/result.h"
#include "core/geo/geodesy.h"
#include "core/time.h"
#include "io/survey/calibration_file.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/calibration/calibration_flight.h"
#include "stages/adapters/flight/smoothing.h"
#include "stages/once.h"

namespace swath::stages {
namespace {

struct NetworkStageOptions : calib::NetworkOptions, FlightViewOptions {};

template <class V>
void describe(NetworkStageOptions& o, V& v) {
  describe(static_cast<calib::NetworkOptions&>(o), v);
  describe(static_cast<FlightViewOptions&>(o), v);
}

struct ValueRow {
  calib::NetworkValue of;
};

template <class V>
void describe(const ValueRow& r, V& v) {
  const core::Form si = core::Form{"SI"}.always();
  v.result("value", r.of.value, si, "Estimate, in rad, m, s or as a ratio.");
  v.result("sigma", r.of.sigma, si, "Its standard deviation.");
  v.result("start", r.of.start, si, "Value in the survey.");
  v.result("start_sigma", r.of.apriori, si, "Standard deviation of that.");
}

struct ComponentRow {
  calib::NetworkComponent of;
};

template <class V>
void describe(const ComponentRow& r, V& v) {
  v.result("observations", r.of.observations, "Number of observations.");
  v.result("redundancy", r.of.redundancy, core::plain(1), "Degrees of freedom that their residuals have.");
  v.result("factor", r.of.factor, core::plain(3), "Sigmas as the residuals show them over those used; absent below 3 degrees of freedom.");
}

/// One line on one plane that the adjustment took no part of.
struct GroupLeftOut {
  int line = 0;
  core::Geodetic at;
  std::string utc;
  std::uint32_t returns = 0;
  double off = 0.0, sigma = 0.0;
};

template <class V>
void describe(const GroupLeftOut& r, V& v) {
  v.result("line", r.line, "Number of the flight line.");
  v.result("latitude_deg", core::to_degrees(r.at.latitude), core::plain(8), "Place of the plane.");
  v.result("longitude_deg", core::to_degrees(r.at.longitude), core::plain(8), "The same.");
  v.result("height_m", r.at.height, core::metres(2), "Its ellipsoidal height.");
  v.result("utc", r.utc, "When the line passed it.");
  v.result("returns", r.returns, "Returns of the line on it.");
  v.result("off_m", r.off, core::metres(), "By which they lie off the plane, along its normal.");
  v.result("sigma_m", r.sigma, core::metres(4), "Standard deviation of that by noise and surface.");
}

/// Those farthest off.
std::vector<GroupLeftOut> left_out_of(const calib::AdjustedNetwork& n) {
  constexpr size_t most = 20;
  std::vector<GroupLeftOut> out;
  for (size_t g = 0; g < n.after.size(); ++g) {
    const calib::PlaneMisfit& m = n.after[g];
    if (m.returns == 0 || m.weight > 0.0) continue;
    const Eigen::Vector3d& centre = n.planes[m.plane].centre;
    out.push_back({n.ties.lines[m.line].id, core::geodetic_of(n.ties.frame.origin + n.ties.frame.local_R_ecef.transpose() * centre),
                   core::utc_text(m.time), m.returns, m.mean, m.sigma});
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return std::abs(a.off) > std::abs(b.off); });
  if (out.size() > most) out.resize(most);
  return out;
}

struct AgainstTruth {
  trajectory::TruthComparison smoother, network;
};

template <class V>
void describe(const AgainstTruth& r, V& v) {
  v.table("smoother", r.smoother, "Errors of the smoother's trajectory.");
  v.table("network", r.network, "Errors of the adjusted trajectory.");
}

struct NetworkFindings {
  std::uint64_t lines = 0, planes = 0, tie_returns = 0, instants = 0, unknowns = 0, left_out = 0, displaced = 0;
  int rounds = 0, iterations = 0;
  bool settled = false, surface_estimated = false;
  double noise_factor = 0.0, last_move = 0.0, surface_sigma = 0.0, range_factor = 1.0, angle_factor = 1.0;
  std::vector<std::pair<std::string, ComponentRow>> components{};
  calib::PlaneAgreement on_planes{};
  std::vector<GroupLeftOut> farthest_off{};
  std::vector<std::pair<std::string, ValueRow>> values{};
  std::vector<std::string> findings{};
  std::optional<AgainstTruth> truth{};
};

template <class V>
void describe(const NetworkFindings& r, V& v) {
  const core::Form shown = core::plain().in_summary(), m = core::metres().always();
  v.result("lines", r.lines, "Flight lines.");
  v.result("planes", r.planes, shown, "Planes that several lines have seen.");
  v.result("tie_returns", r.tie_returns, "Returns on these planes.");
  v.result("groups_left_out", r.left_out, "Groups of returns (one line on one plane) without weight: far off their plane.");
  v.result("groups_displaced", r.displaced, "Groups that the test of displacements (snooping) left out.");
  v.tables("left_out", r.farthest_off, "Up to 20 of these, farthest off first: things that moved or grew, or a line that does not fit.");
  v.result("instants", r.instants, "Instants with a navigation state of their own.");
  v.result("unknowns", r.unknowns, "Unknowns of the system, planes not counted.");
  v.result("rounds", r.rounds, "Searches for planes.");
  v.result("iterations", r.iterations, "Linearisations.");
  v.result("settled", r.settled, shown, "False: the states still moved when the iterations ended.");
  v.result("last_move_m", r.last_move, m, "RMS by which the last round moved returns from their planes.");
  v.result("noise_factor", r.noise_factor, core::plain(2),
           "Robust scatter of single returns about their group, in the sigmas that were used.");
  v.result("range_factor", r.range_factor, core::plain(2), "Sigma of the ranges as their scatter on planes shows it, over the stated one.");
  v.result("angle_factor", r.angle_factor, core::plain(2), "The same of scan angles and pointing.");
  v.result("surface_sigma_m", r.surface_sigma, m, "Sigma by which a plane seen in one line departs from that of all lines.");
  v.result("surface_estimated", r.surface_estimated, "True: from the residuals; false: as stated.");
  v.named_tables("components", r.components, "Kinds of observation: how large their residuals are beside their sigmas.");
  v.result("pairs_on_planes", r.on_planes.pairs, "Pairs of lines on common planes.");
  v.result("rms_before_m", r.on_planes.before, m.in_summary(), "RMS difference of two lines on a plane, with the smoother's trajectory.");
  v.result("rms_after_m", r.on_planes.after, m.in_summary(), "The same with the adjusted trajectory.");
  v.named_tables("values", r.values, "Calibration values that were unknowns.");
  v.result("findings", r.findings, "What the adjustment found, as sentences.");
  v.table("truth", r.truth, "Errors against the truth of a simulated survey.");
}

NetworkFindings found_by(const calib::AdjustedNetwork& n) {
  NetworkFindings f;
  f.lines = n.ties.lines.size();
  f.planes = n.ties.planes.size();
  f.tie_returns = n.ties.returns.size();
  f.instants = n.instants, f.unknowns = n.unknowns, f.left_out = n.left_out;
  f.rounds = n.rounds, f.iterations = n.iterations, f.settled = n.settled;
  f.noise_factor = n.noise_factor, f.last_move = n.last_move;
  f.displaced = n.displaced, f.surface_sigma = n.surface_sigma, f.surface_estimated = n.surface_estimated;
  f.range_factor = n.range_factor, f.angle_factor = n.angle_factor;
  for (const calib::NetworkComponent& c : n.components) f.components.emplace_back(c.kind, ComponentRow{c});
  f.on_planes = calib::agreement_on_planes(n);
  f.farthest_off = left_out_of(n);
  for (const calib::NetworkValue& v : n.values) f.values.emplace_back(std::string(calib::words_of(v.parameter).key), ValueRow{v});
  return f;
}

/// The sensor's sigmas with those that the adjustment found, and the correlations of what it found.
core::SensorSigma sigma_of(const calib::AdjustedNetwork& n, core::SensorSigma s) {
  double arm = 0.0;
  for (const calib::NetworkValue& v : n.values) switch (v.parameter) {
      case calib::boresight_roll:
        s.roll.value = v.sigma;
        break;
      case calib::boresight_pitch:
        s.pitch.value = v.sigma;
        break;
      case calib::boresight_heading:
        s.heading.value = v.sigma;
        break;
      case calib::range_offset:
        s.range_offset.value = v.sigma;
        break;
      case calib::range_scale:
        s.range_scale = v.sigma;
        break;
      case calib::scan_offset:
        s.scan_offset.value = v.sigma;
        break;
      case calib::scan_scale:
        s.scan_scale = v.sigma;
        break;
      case calib::latency:
        s.latency.value = v.sigma;
        break;
      default:
        arm = std::max(arm, v.sigma);
    }
  if (arm > 0.0) s.lever_arm.value = arm;
  constexpr size_t all = core::calibration_keys.size();
  s.correlation.assign(all * all, 0.0);
  for (size_t i = 0; i < all; ++i) s.correlation[i * all + i] = 1.0;
  for (size_t i = 0; i < n.values.size(); ++i)
    for (size_t j = 0; j < n.values.size(); ++j)
      s.correlation[static_cast<size_t>(n.values[i].parameter) * all + static_cast<size_t>(n.values[j].parameter)] =
          i == j ? 1.0 : n.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) / (n.values[i].sigma * n.values[j].sigma);
  return s;
}

std::vector<std::string> network_products(const NetworkStageOptions&) {
  return with_report({"network.json", "calibration.json", "adjustment.json"});
}

void expect_spec(const Context& context, const NetworkStageOptions&) { require_imu_spec(context.survey, "calib.network"); }

std::vector<std::filesystem::path> network_inputs(const io::Survey& survey) {
  std::vector<std::filesystem::path> out = true_trajectory(survey);
  for (const auto& f : files_in<&io::Survey::control>(survey)) out.push_back(f);
  return out;
}

Given<trajectory::Trajectory, NetworkFindings> adjust_survey(core::ImuData imu, const core::GnssData& gnss, const Context& context,
                                                             const georef::ShotStream& shots, const NetworkStageOptions& o,
                                                             const Output& to, const core::OnProgress& progress, core::Tally& tally) {
  const io::Survey& survey = context.survey;
  const double rate = o.smoother.output_rate.value;
  trajectory::SmoothedFlight left;
  trajectory::InsGnssResult smoothed = smooth_records(std::move(imu), gnss, survey, o.smoother, progress, &left);
  for (const std::string& w : smoothed.report.warnings) tally.count("warnings of the smoother", w);
  for (const trajectory::NamedFault& n : smoothed.report.figures.named) tally.count("warnings of the smoother", n.sentence);
  const trajectory::Trajectory before = as_flown(std::move(smoothed.trajectory), rate, "calib.network");
  const calib::PreparedFlight prepared(survey, shots, context.threads, before, {}, tally);
  calib::NetworkOptions how = o;
  how.apriori = calib::start_sigmas(survey.sigma);
  calib::AdjustedNetwork network = calib::adjust_network(prepared.flight, left, how, tally, progress);
  if (!network.settled) tally.count("the adjustment did not settle: raise iterations, or look for lines that do not fit");

  trajectory::Trajectory after = as_flown(std::move(network.trajectory), rate, "calib.network");
  NetworkFindings findings = found_by(network);
  if (const auto truth = truth_of(survey, before.data()))
    findings.truth = AgainstTruth{compare_with_truth(survey, trajectory::errors_against(before.data(), *truth)),
                                  compare_with_truth(survey, trajectory::errors_against(after.data(), *truth))};
  calib::CalibrationReport report = report_on(context, prepared.lines);
  calib::put_network(network, before, after, report);
  findings.findings = calib::sentences(report.adjustment.findings);
  calib::add_views(prepared.flight, {context.crs, context.unit, context.origin}, {network.calibration, after}, o.differences,
                   prepared.cell(), o.sections, report);
  calib::write_calibration_report(report, to.folder);
  io::write_text_file(to.folder / "calibration.json",
                      io::to_json(io::calibration_tree(network.calibration, sigma_of(network, survey.sigma))));
  io::write_text_file(to.folder / "network.json", io::to_json(core::reported(findings)));
  if (!network.values.empty())
    tally.count("calibration values were estimated: georeference with calibration.json in another run, this one has the survey's");
  return {std::move(after), std::move(findings)};
}

double network_memory(const core::ImuData& imu, const NetworkStageOptions& o) {
  constexpr double bytes_per_instant = 0.125e6;  // factor, inverse and observations: 0.115e6 to 0.14e6, 4 to 50 lines
  return smoothing_memory(imu, o.smoother) + bytes_per_instant * smoother_nodes(imu, o.smoother);
}

}  // namespace

Entry network_stage() {
  return once<adjust_survey>(
      "calib.network",
      "Joint adjustment of IMU and GNSS records and of planes that several flight lines have seen: trajectory with "
      "covariances, calibration values if asked; network.json and calibration.json.",
      {.check = expect_spec, .inputs = network_inputs, .products = network_products, .memory = memory_by<network_memory>});
}

}  // namespace swath::stages
