// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/flight_plan/budget.h"

#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "io/records/trajectory_file.h"
#include "io/survey/read_survey.h"

namespace swath::pipeline {
namespace {

constexpr double widest = 80.0 * core::degree;

double rms(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0.0;
  size_t n = 0;
  for (const auto* column : {&a, &b})
    for (const float v : *column)
      if (std::isfinite(v)) {
        sum += static_cast<double>(v) * static_cast<double>(v);
        ++n;
      }
  return n > 0 ? std::sqrt(sum / static_cast<double>(n)) : 0.0;
}

planning::TrajectorySigma trajectory_of(const io::Survey& survey, std::string& from) {
  planning::TrajectorySigma out;
  from = "usual values: the survey names no trajectory with sigmas";
  if (survey.trajectory.empty()) return out;
  core::Tally tally;
  const core::TrajectoryData t = io::read_trajectory(survey, tally);
  if (t.sigma_north.empty()) return out;
  out.horizontal = core::Metres(rms(t.sigma_north, t.sigma_east));
  out.vertical = core::Metres(rms(t.sigma_down, {}));
  out.roll_pitch = core::Radians(rms(t.sigma_roll, t.sigma_pitch));
  out.heading = core::Radians(rms(t.sigma_heading, {}));
  from = "rms of the sigmas that the survey's trajectory states";
  return out;
}

}  // namespace

BudgetTable budget_of(const BudgetRequest& request) {
  if (!(request.height > 0.0)) throw core::usage_error("the height must be above 0", "--height", "write it with its unit: \"600 m\"");
  for (const double angle : request.angles)
    if (!(std::abs(angle) < widest))
      throw core::usage_error("a scan angle must be below 80 deg", "--angle", "write it with its unit: \"20 deg\"");
  const io::Survey survey = io::read_survey(request.survey);
  BudgetTable out;
  const planning::TrajectorySigma trajectory = trajectory_of(survey, out.trajectory);
  out.slope = request.slope;
  out.budget = planning::budgets_at(survey.sigma, trajectory, request.height, request.speed, request.angles);
  for (const double angle : request.angles) {
    const planning::ErrorBudget b =
        planning::error_budget(planning::sources_of(survey.sigma, trajectory, request.height, angle, request.speed), request.height, angle);
    const Eigen::Vector3d total = b.total();
    out.surface.push_back({angle, total.head<2>().norm(), total.z(), planning::surface_sigma(b, 0.0, request.slope)});
  }
  if (request.penetration) {
    out.forest = planning::forest_sigma(std::atan(request.slope), *request.penetration);
    if (!out.forest)
      throw core::usage_error("below 25 % of the pulses on the ground no sigma is stated for terrain under forest", "--penetration",
                              "Brandalize (15) is for 25 % and more");
  }
  return out;
}

std::string budget_text(const BudgetTable& t) {
  std::string out;
  char line[200];
  const auto row = [&](const char* name, const Eigen::Vector3d& e) {
    std::snprintf(line, sizeof line, "  %-14s %10.2f %10.2f %10.2f\n", name, 100 * e.x(), 100 * e.y(), 100 * e.z());
    out += line;
  };
  for (size_t k = 0; k < t.budget.size(); ++k) {
    const planning::BudgetFound& b = t.budget[k];
    std::snprintf(line, sizeof line, "scan angle %.1f deg, %.0f m above the ground; cm    along     across         up\n",
                  core::to_degrees(b.angle), b.height);
    out += line;
    for (const planning::BudgetRow& r : b.rows) row(r.source.c_str(), r.error);
    row("all together", b.total);
    std::snprintf(line, sizeof line, "  place %.1f cm, height %.1f cm, ground with slope %g %.1f cm\n", 100 * t.surface[k].horizontal,
                  100 * t.surface[k].vertical, t.slope, 100 * t.surface[k].surface);
    out += line;
  }
  if (t.forest) {
    std::snprintf(line, sizeof line, "terrain under forest: %.0f cm\n", 100 * *t.forest);
    out += line;
  }
  return out + "trajectory: " + t.trajectory + "\n";
}

}  // namespace swath::pipeline
