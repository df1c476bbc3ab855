// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/flight_charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/statistics.h"
#include "core/time.h"

namespace swath::report {
namespace {

using Eigen::Vector3d;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double arc_second = core::degree / 3600.0, degree_per_hour = core::degree / 3600.0, micro_g = 9.80665e-6;
constexpr std::array<const char*, 3> ned{"North", "East", "Down"}, rph{"Roll", "Pitch", "Heading"}, xyz{"x", "y", "z"};
constexpr int small_panel = 170;  // of charts with many panels, pixels
/// Shares of the values that a panel's range goes by: the others belong to the alignment at both ends of the flight, or are outliers.
constexpr double aligned_share = 0.8, separation_share = 0.95, innovation_share = 0.99;
/// The palette's colours by meaning (report/chart.h: an index).
constexpr int blue = 0, orange_red = 1, green = 2, purple = 3, grey = 4, amber = 5, sky = 6;

std::vector<double> component(const std::vector<Vector3d>& rows, Eigen::Index k, double unit) {
  std::vector<double> out;
  out.reserve(rows.size());
  for (const Vector3d& r : rows) out.push_back(r[k] / unit);
  return out;
}

class Charts {
 public:
  Charts(const core::TrajectoryData& trajectory, const core::SmootherSeries& series, const core::GnssData& gnss)
      : trajectory_(trajectory), series_(series), gnss_(gnss), week_(core::week_of(first_time())) {}

  Chart track() const;
  Chart sigma() const;
  Chart separation() const;
  Chart separation_attitude() const;
  Chart innovations() const;
  Chart residuals() const;
  Chart attitude() const;
  Chart biases() const;
  Chart heading() const;
  Chart errors(const core::TrajectoryErrors& e, bool of_position) const;

 private:
  double first_time() const { return trajectory_.size() ? trajectory_.time.front() : 0.0; }
  std::vector<double> seconds(const std::vector<double>& times) const {
    std::vector<double> out;
    out.reserve(times.size());
    for (const double t : times) out.push_back(t - week_ * core::seconds_per_week);
    return out;
  }
  Panel panel(std::string title, std::string y_label) const {
    Panel p;
    p.title = std::move(title);
    p.x_label = "time in GPS week " + std::to_string(week_) + " (s)";
    p.y_label = std::move(y_label);
    return p;
  }
  const core::TrajectoryData& trajectory_;
  const core::SmootherSeries& series_;
  const core::GnssData& gnss_;
  int week_;
};

Chart Charts::track() const {
  Chart c;
  c.title = "Track";
  Panel p;
  p.title = "Trajectory and GNSS fixes";
  p.x_label = "east (m)";
  p.y_label = "north (m)";
  p.equal_scale = true;
  const core::TrajectoryData& t = trajectory_;
  if (t.size() == 0) return c;
  const Vector3d origin = core::ecef_of({t.latitude[0], t.longitude[0], t.height[0]});
  const Eigen::Matrix3d ned_R_ecef = core::ecef_R_ned(t.latitude[0], t.longitude[0]).transpose();
  const auto add = [&](Series& s, const Vector3d& ecef) {
    const Vector3d local = ned_R_ecef * (ecef - origin);
    s.x.push_back(local[1]);
    s.y.push_back(local[0]);
  };
  Series line{"trajectory", {}, {}, {}, Mark::line, grey};
  // Ten records a second at most: an aircraft's track bends no faster.
  constexpr double spacing = 0.1;
  double last = -spacing;
  for (size_t i = 0; i < t.size(); ++i) {
    if (i > 0 && i + 1 < t.size() && t.time[i] - last < spacing) continue;
    last = t.time[i];
    add(line, core::ecef_of({t.latitude[i], t.longitude[i], t.height[i]}));
  }
  using Quality = core::FixQuality;
  for (const auto& [quality, colour] :
       {std::pair{Quality::single, purple}, std::pair{Quality::sbas, purple}, std::pair{Quality::differential, amber},
        std::pair{Quality::ppp, sky}, std::pair{Quality::float_ambiguity, orange_red}, std::pair{Quality::fixed, green},
        std::pair{Quality::unknown, blue}}) {
    Series fixes{std::string(core::Choices<Quality>::names[static_cast<size_t>(quality)]), {}, {}, {}, Mark::dots, colour};
    if (quality == Quality::unknown) fixes.name = "fixes";
    for (size_t i = 0; i < gnss_.size(); ++i)
      if (gnss_.quality[i] == quality && gnss_.position[i].allFinite()) add(fixes, gnss_.position[i]);
    if (!fixes.x.empty()) p.series.push_back(std::move(fixes));
  }
  p.series.push_back(std::move(line));  // over the fixes: they may be dense
  c.panels.push_back(std::move(p));
  return c;
}

Chart Charts::sigma() const {
  Chart c;
  c.title = "Standard deviations of the smoothed trajectory";
  const core::CovarianceSeries& nodes = trajectory_.covariance;
  Panel position = panel("Position", "sigma (m)"), attitude = panel("Attitude", "sigma (arcsec)");
  position.log_y = attitude.log_y = true;
  const std::vector<double> time = seconds(nodes.time);
  for (size_t k = 0; k < 3; ++k) {
    Series p{ned[k], time, {}, {}, Mark::line, -1}, a{rph[k], time, {}, {}, Mark::line, -1};
    for (const auto& packed : nodes.upper) {
      const auto variance = core::CovarianceSeries::unpack(packed).diagonal().eval();
      p.y.push_back(std::sqrt(variance[static_cast<Eigen::Index>(k)]));
      a.y.push_back(std::sqrt(variance[static_cast<Eigen::Index>(6 + k)]) / arc_second);
    }
    position.series.push_back(std::move(p));
    attitude.series.push_back(std::move(a));
  }
  c.panels = {position, attitude};
  return c;
}

Chart Charts::separation() const {
  Chart c;
  c.title = "Forward minus backward solution";
  for (size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    Panel p = panel(ned[k], "separation (m)");
    p.y_share = separation_share;
    p.series = {{"its sigma", seconds(series_.time), component(series_.separation_sigma, axis, 1.0), {}, Mark::band, static_cast<int>(k)},
                {"separation", seconds(series_.time), component(series_.separation, axis, 1.0), {}, Mark::line, static_cast<int>(k)}};
    c.panels.push_back(std::move(p));
  }
  return c;
}

Chart Charts::separation_attitude() const {
  Chart c;
  c.title = "Forward minus backward attitude";
  for (size_t k = 0; k < 3; ++k) {
    Panel p = panel(rph[k], "separation (arcsec)");
    p.y_share = aligned_share;
    p.series = {{"",
                 seconds(series_.time),
                 component(series_.attitude_separation, static_cast<Eigen::Index>(k), arc_second),
                 {},
                 Mark::line,
                 static_cast<int>(k)}};
    c.panels.push_back(std::move(p));
  }
  return c;
}

Chart Charts::innovations() const {
  Chart c;
  c.title = "Innovations of the forward filter";
  c.panel_height = 200;
  const std::vector<double> time = seconds(series_.fix_time);
  const auto weighted = [this](std::vector<double> values, bool down) {
    for (size_t i = 0; i < values.size(); ++i)
      if ((series_.weight[i] < 1.0) != down) values[i] = nan;
    return values;
  };
  for (size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    const std::vector<double> values = component(series_.innovation, axis, 1.0);
    Panel p = panel(ned[k], "innovation (m)");
    p.y_share = innovation_share;
    p.series = {{"its sigma", time, component(series_.innovation_sigma, axis, 1.0), {}, Mark::band, blue},
                {"fix minus prediction", time, weighted(values, false), {}, Mark::dots, blue},
                {"down-weighted", time, weighted(values, true), {}, Mark::dots, orange_red}};
    c.panels.push_back(std::move(p));
  }
  Panel p = panel("Normalised innovation squared, 3 degrees of freedom", "NIS");
  p.log_y = true;
  p.y_share = innovation_share;
  constexpr double bound = 7.815;  // 95 % of chi-square with 3 degrees of freedom
  p.series = {{"NIS", time, weighted(series_.nis, false), {}, Mark::dots, blue},
              {"down-weighted", time, weighted(series_.nis, true), {}, Mark::dots, orange_red}};
  if (!time.empty()) p.series.push_back({"95 %", {time.front(), time.back()}, {bound, bound}, {}, Mark::line, grey});
  c.panels.push_back(std::move(p));
  return c;
}

Chart Charts::residuals() const {
  Chart c;
  c.title = "Fixes minus smoothed antenna positions";
  c.panel_height = 200;
  for (size_t k = 0; k < 3; ++k) {
    Panel p = panel(ned[k], "residual (m)");
    p.y_share = innovation_share;
    p.series = {{"", seconds(series_.fix_time), component(series_.residual, static_cast<Eigen::Index>(k), 1.0), {}, Mark::dots, blue}};
    c.panels.push_back(std::move(p));
  }
  return c;
}

Chart Charts::attitude() const {
  Chart c;
  c.title = "Attitude";
  const core::TrajectoryData& t = trajectory_;
  // Far more records than the picture has columns need not be held twice.
  constexpr size_t most = 200000;
  const size_t every = t.size() / most + 1;
  std::vector<double> time, roll, pitch, heading;
  for (size_t i = 0; i < t.size(); i += every) {
    time.push_back(t.time[i] - week_ * core::seconds_per_week);
    roll.push_back(core::to_degrees(t.roll[i]));
    pitch.push_back(core::to_degrees(t.pitch[i]));
    const double h = core::to_degrees(core::wrap_two_pi(t.heading[i]));
    // No line from 359 to 1 deg.
    const bool through_north = !heading.empty() && std::abs(h - heading.back()) > 180.0;
    heading.push_back(through_north ? nan : h);
  }
  Panel level = panel("Roll (right wing down) and pitch (nose up)", "angle (deg)"), course = panel("Heading", "heading (deg)");
  level.series = {{"roll", time, roll, {}, Mark::line, blue}, {"pitch", time, pitch, {}, Mark::line, orange_red}};
  course.series = {{"", time, heading, {}, Mark::line, green}};
  c.panels = {level, course};
  return c;
}

Chart Charts::biases() const {
  Chart c;
  c.title = "Biases of the IMU with their standard deviations";
  c.panel_height = small_panel;
  const auto add = [&](const char* sensor, const char* unit_name, double unit, const std::vector<Vector3d>& value,
                       const std::vector<Vector3d>& sigma) {
    for (size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      const std::vector<double> time = seconds(series_.time), v = component(value, axis, unit), s = component(sigma, axis, unit);
      Series band{"", time, v, v, Mark::band, static_cast<int>(k)};
      for (size_t i = 0; i < v.size(); ++i) {
        band.y[i] += s[i];
        band.y2[i] -= s[i];
      }
      Panel p = panel(std::string(sensor) + " " + xyz[k], unit_name);
      p.series = {band, {"", time, v, {}, Mark::line, static_cast<int>(k)}};
      c.panels.push_back(std::move(p));
    }
  };
  add("Gyro", "deg/h", degree_per_hour, series_.gyro_bias, series_.gyro_bias_sigma);
  add("Accelerometer", "micro-g", micro_g, series_.accelerometer_bias, series_.accelerometer_bias_sigma);
  return c;
}

Chart Charts::heading() const {
  Chart c;
  c.title = "Heading before and after smoothing";
  std::vector<double> difference, size;
  for (const double d : series_.heading_forward) {
    difference.push_back(d / arc_second);
    if (std::isfinite(d)) size.push_back(std::abs(d / arc_second));
  }
  Panel all = panel("Forward filter minus smoothed", "difference (arcsec)");
  all.series = {{"", seconds(series_.time), difference, {}, Mark::line, green}};
  c.panels.push_back(all);
  if (size.empty()) return c;
  // While the filter still aligns it is far off: a second look at the rest of the flight.
  constexpr double far = 5.0;
  if (*std::max_element(size.begin(), size.end()) > far * core::quantile(size, aligned_share)) {
    all.title = "The same, enlarged";
    all.y_share = aligned_share;
    c.panels.push_back(std::move(all));
  }
  return c;
}

Chart Charts::errors(const core::TrajectoryErrors& e, bool of_position) const {
  Chart c;
  c.title = of_position ? "Errors of position against truth" : "Errors of attitude against truth";
  const double unit = of_position ? 1.0 : arc_second;
  // As for the attitude: no more records than a picture can distinguish by far.
  constexpr size_t most = 200000;
  const size_t every = e.size() / most + 1;
  const auto thinned = [every](const auto& rows) {
    std::remove_cvref_t<decltype(rows)> out;
    for (size_t i = 0; i < rows.size(); i += every) out.push_back(rows[i]);
    return out;
  };
  const std::vector<double> time = seconds(thinned(e.time));
  const auto error = thinned(of_position ? e.position : e.attitude), sigma = thinned(of_position ? e.position_sigma : e.attitude_sigma);
  for (size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    Panel p = panel(of_position ? ned[k] : rph[k], of_position ? "error (m)" : "error (arcsec)");
    if (!sigma.empty()) p.series.push_back({"printed sigma", time, component(sigma, axis, unit), {}, Mark::band, static_cast<int>(k)});
    p.series.push_back({"error", time, component(error, axis, unit), {}, Mark::line, static_cast<int>(k)});
    c.panels.push_back(std::move(p));
  }
  return c;
}

}  // namespace

std::vector<NamedChart> flight_charts(const core::TrajectoryData& trajectory, const core::SmootherSeries& series,
                                      const core::GnssData& gnss, const std::optional<core::TrajectoryErrors>& errors) {
  const Charts c(trajectory, series, gnss);
  std::vector<NamedChart> out{{"track", c.track()},
                              {"sigma", c.sigma()},
                              {"separation", c.separation()},
                              {"separation_attitude", c.separation_attitude()},
                              {"innovations", c.innovations()},
                              {"residuals", c.residuals()},
                              {"attitude", c.attitude()},
                              {"biases", c.biases()},
                              {"heading", c.heading()}};
  if (errors) {
    out.push_back({"errors_position", c.errors(*errors, true)});
    out.push_back({"errors_attitude", c.errors(*errors, false)});
  }
  return out;
}

}  // namespace swath::report
