// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "calib/calibrate.h"
#include "calib/flown_lines.h"
#include "core/error.h"
#include "stages/adapters/adapters.h"
#include "stages/calibration/verdict.h"
#include "stages/calibration_report.h"
#include "stages/calibration_views.h"
#include "stages/shot_source.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

struct AdjustStageOptions : calib::CalibrateOptions {
  trajectory::ErrorModelOptions errors;
  calib::LineHeightOptions differences;
  int sections = 4;
};

template <class V>
void describe(AdjustStageOptions& o, V& v) {
  describe(static_cast<calib::CalibrateOptions&>(o), v);
  v.table("errors", o.errors, "Errors of trajectories that state no covariances between instants.");
  v.table("differences", o.differences, "Maps of the differences of overlapping lines.");
  v.option("sections", o.sections, core::within(0, 50), "Cross sections drawn in the report.");
}

double metres_down(const std::vector<calib::FlownLine>& lines) {
  double sum = 0, n = 0;
  for (const calib::FlownLine& l : lines)
    if (std::isfinite(l.height)) sum += l.height, n += 1;
  return n > 0 ? sum / n : 0.0;
}

/// Wide enough for a plane of a line's returns, in whole half metres.
double cell_for(const std::vector<calib::FlownLine>& lines) {
  constexpr double returns = 12, step = 0.5;
  return std::max(step, step * std::ceil(calib::side_for(lines, returns) / step));
}

class Adjust : public OptionStage<AdjustStageOptions> {
 public:
  const Info& info() const override {
    static const Info info{"calib.adjust",
                           "Rigorous adjustment of a calibration flight: boresight, range and scan corrections and the trajectory's line "
                           "corrections from planes "
                           "that several lines have seen; calibration.json and report.html.",
                           {Grain::survey},
                           {},
                           {},
                           {Product::trajectory, Product::shots},
                           {}};
    return info;
  }
  std::vector<std::string> products() const override {
    return {"calibration.json", "report.html", "residuals.csv", "corrections.csv", "planes.csv", "sections.csv", "figures", "differences"};
  }
  std::vector<fs::path> inputs(const io::Survey& survey) const override {
    std::vector<fs::path> out;
    for (const io::ControlFile& f : survey.control) out.push_back(io::resolve(survey, f.file));
    return out;
  }

  void run_survey(Context& context, core::Tally& tally, core::Value& findings) const override {
    const io::Survey& survey = context.survey;
    const trajectory::Trajectory& trajectory = *context.trajectory;
    calib::CalibrationFlight flight;
    flight.shots = stream_shots(context);
    flight.scanner = survey.scanner;
    flight.start = survey.calibration;
    flight.sensor = survey.sigma;
    flight.trajectory = &trajectory;
    const trajectory::ErrorModel errors(trajectory.data(), options.errors);
    flight.errors = &errors;
    flight.threads = context.threads;

    const std::vector<calib::FlownLine> lines = fly(flight, tally);
    std::vector<std::pair<double, double>> times;
    for (const calib::FlownLine& l : lines) times.emplace_back(l.first, l.last);
    flight.frame = calib::frame_of(times, metres_down(lines), trajectory);
    const std::vector<io::ControlPoint> control = io::read_control(survey, tally);
    flight.targets = calib::surveyed_targets(control, flight.frame, tally);

    const calib::Calibrated calibrated = calib::calibrate(flight, options, tally);
    CalibrationReport report = report_of(context, calibrated, lines);
    const DeliveredCalibration result = delivered(calibrated.adjustment, survey.sigma);
    add_views(report, view_calibration(context, {&survey.calibration, &trajectory}, {&result.calibration, &trajectory}, calibrated.ties,
                                       control, options.differences, cell_for(lines), static_cast<size_t>(options.sections)));
    write_calibration_report(report, context.output);
    tell(calibrated, findings);
  }

 private:
  /// The lines of the flight; what is wrong with them is counted, or refused.
  static std::vector<calib::FlownLine> fly(const calib::CalibrationFlight& flight, core::Tally& tally) {
    const calib::ShotGeometry geometry(flight.scanner, flight.start);
    calib::FlownLines flown(geometry, *flight.trajectory);
    flight.shots([&](int line, const core::Shots& shots) { flown.add(line, shots); });
    const std::vector<calib::FlownLine> lines = flown.lines();
    for (const calib::Finding& f : calib::check_lines(lines)) {
      if (f.refuses) throw core::Error(f.what, "laser records", f.cure);
      tally.count(f.what + " (" + f.cure + ")");
    }
    return lines;
  }

  static CalibrationReport report_of(const Context& context, const calib::Calibrated& calibrated,
                                     const std::vector<calib::FlownLine>& lines) {
    CalibrationReport report;
    report.survey = context.survey.name;
    report.crs = context.product_crs;
    report.sensor = context.survey.sigma;
    report.adjustment = calibrated.adjustment;
    report.ties = calibrated.ties;
    report.notes = calibrated.notes;
    for (const calib::FlownLine& l : lines) {
      const auto named =
          std::find_if(context.survey.lines.begin(), context.survey.lines.end(), [&](const io::FlightLine& f) { return f.id == l.id; });
      report.lines.push_back({l.id, named == context.survey.lines.end() ? std::string() : named->name, l.heading, l.height, l.speed,
                              l.length, l.first, l.last, l.returns});
    }
    return report;
  }

  static void add_views(CalibrationReport& report, CalibrationViews views) {
    for (size_t k = 0; k < views.sections.size(); ++k) {
      CrossSection section{views.sections[k].name, views.sections[k].width, views.sections[k].ends, {}, {}};
      for (const auto& [line, r] : views.sections_before[k]) section.before.push_back({line, r.along, r.height});
      for (const auto& [line, r] : views.sections_after[k]) section.after.push_back({line, r.along, r.height});
      report.sections.push_back(std::move(section));
    }
    for (calib::LineDifferenceMap& after : views.after) {
      const auto before = std::find_if(views.before.begin(), views.before.end(), [&](const calib::LineDifferenceMap& m) {
        return m.statistics.line_a == after.statistics.line_a && m.statistics.line_b == after.statistics.line_b;
      });
      LineDifference both{after.statistics.line_a, after.statistics.line_b, core::Grid(), std::move(after.grid)};
      both.before = before == views.before.end() ? core::Grid(both.after.lattice) : on_lattice(before->grid, both.after.lattice);
      report.differences.push_back(std::move(both));
    }
    for (const calib::CheckResidual& c : views.checks)
      if (std::isfinite(c.difference)) report.checks.push_back({c.name, 0, c.difference, c.sigma, 1.0, c.difference / c.sigma, false});
  }

  /// The same cells of another lattice of the same cell size; void where the grid does not reach.
  static core::Grid on_lattice(const core::Grid& from, const core::Lattice& lattice) {
    core::Grid out(lattice);
    for (int j = 0; j < lattice.ny; ++j)
      for (int i = 0; i < lattice.nx; ++i) {
        const auto si = lattice.i0 + i - from.lattice.i0, sj = lattice.j0 + j - from.lattice.j0;
        if (si < 0 || sj < 0 || si >= from.lattice.nx || sj >= from.lattice.ny) continue;
        const size_t at = from.lattice.at(static_cast<int>(si), static_cast<int>(sj));
        out.height[lattice.at(i, j)] = from.height[at];
        out.reason[lattice.at(i, j)] = from.reason[at];
      }
    return out;
  }

  static void tell(const calib::Calibrated& c, core::Value& findings) {
    for (const calib::Estimate& e : c.adjustment.estimates) {
      if (!e.estimated) continue;
      core::Value one = core::Value::object();
      one["value"] = e.value;
      one["sigma"] = e.sigma;
      one["start"] = e.start;
      findings["estimates"][std::string(words_of(e.parameter).key)] = std::move(one);
    }
    findings["planes"] = c.ties.planes.size();
    findings["tie_returns"] = c.ties.returns.size();
    findings["rounds"] = c.rounds;
    findings["sigma0"] = c.adjustment.sigma0;
    core::Value& words = findings["findings"] = core::Value::array();
    for (const calib::Finding& f : c.adjustment.findings) words.push(f.what + (f.cure.empty() ? "" : ": " + f.cure));
  }
};

}  // namespace

std::unique_ptr<Stage> make_adjust() { return std::make_unique<Adjust>(); }

}  // namespace swath::stages
