// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of smoothed trajectories between instants: error_bench [FLIGHTS] (30). Flights of four lines of 25 s with turns between them, IMU
// at 100 Hz, GNSS at 5 Hz, flight and errors drawn anew for each. Prints how the errors of one component hang together over time, and the
// error of what a calibration sees of them (mean and slope over a line, difference of the means of neighbouring lines) over its predicted
// sigma.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "core/error.h"
#include "tests/world/navigation.h"
#include "trajectory/ins/error_model.h"
#include "trajectory/ins/ins_gnss.h"

namespace {

using namespace swath;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr std::array<double, 9> lags{1, 2, 5, 10, 20, 30, 60, 120, 300};  // s
constexpr double every = 0.5, line_seconds = 25.0;                        // s
constexpr std::array<const char*, 6> names{"north", "east", "down", "roll", "pitch", "heading"};

simulate::PlannedFlight flight_of(std::uint64_t seed) {
  simulate::FlightOptions options;
  options.line_length = core::Metres(1500);
  options.lines = 4;
  options.cross_lines = 0;
  const auto number = static_cast<std::int64_t>(seed);
  return {options,
          {48 * core::degree, 10.5 * core::degree, 600.0},
          950.0,
          simulate::plan_lines(options, {}, core::degrees(20).value, 0.02),
          0.7 * static_cast<double>(seed),
          number};
}

/// What is summed up over the flights of one grade.
struct Sums {
  Eigen::Array<double, 6, static_cast<int>(lags.size())> likeness = decltype(likeness)::Zero();
  Eigen::Array<double, 6, 3> squares = Eigen::Array<double, 6, 3>::Zero();  // mean, slope, difference of means
  Eigen::Array<double, 6, 1> variance = Eigen::Array<double, 6, 1>::Zero(), mean_variance = variance;
  double likenesses = 0, lines = 0, pairs = 0;
};

/// Rows of mean and slope of the six over the instants of a line.
MatrixXd mean_and_slope(const std::vector<double>& t) {
  double mean = 0, squares = 0;
  for (const double v : t) mean += v / static_cast<double>(t.size());
  for (const double v : t) squares += (v - mean) * (v - mean);
  MatrixXd rows(12, 6 * static_cast<Index>(t.size()));
  for (size_t k = 0; k < t.size(); ++k)
    rows.middleCols<6>(6 * static_cast<Index>(k)) << Matrix6::Identity() / static_cast<double>(t.size()),
        Matrix6::Identity() * ((t[k] - mean) / squares);
  return rows;
}

void add(Sums& sums, core::ImuGrade grade, std::uint64_t seed) {
  const simulate::PlannedFlight flight = flight_of(seed);
  const test::MotionAt motion = test::motion_of(flight);
  test::Sensors sensors{.from = 0, .until = flight.duration(), .imu_step = 0.01};
  const core::ImuErrorModel model = core::error_model_of(grade);
  const test::Records records = test::exact_records(motion, sensors);
  const trajectory::InsGnssResult result = trajectory::smooth(
      test::with_errors(records.imu, model, seed), test::with_errors(records.gnss, test::FixErrors{}, seed), model, sensors.lever, 0.02);
  const core::TrajectoryData& d = result.trajectory;
  const trajectory::ErrorModel errors(d);

  std::vector<double> times, at_lines;
  std::vector<double> seen;
  std::vector<std::pair<size_t, size_t>> lines;
  size_t next = 0;
  for (const simulate::Line& line : flight.lines()) {
    const double from = test::motion_start + 0.5 * (line.start + line.end - line_seconds);
    const size_t first = times.size();
    for (double t = from; t <= from + line_seconds; t += every) {
      while (next + 1 < d.size() && d.time[next] < t) ++next;
      times.push_back(d.time[next]);
      const test::Error6 e = test::error_of(d, next, motion);
      seen.insert(seen.end(), e.begin(), e.end());
    }
    lines.emplace_back(first, times.size());
  }
  const MatrixXd c = errors.covariance(times);
  std::vector<VectorXd> means;
  std::vector<MatrixXd> rows;
  for (const auto& [first, last] : lines) {
    const MatrixXd part =
        mean_and_slope({times.begin() + static_cast<std::ptrdiff_t>(first), times.begin() + static_cast<std::ptrdiff_t>(last)});
    MatrixXd whole = MatrixXd::Zero(12, c.cols());
    whole.middleCols(6 * static_cast<Index>(first), part.cols()) = part;
    const VectorXd value = whole * Eigen::Map<const VectorXd>(seen.data(), c.cols());
    const VectorXd variance = (whole * c * whole.transpose()).diagonal();
    sums.squares.col(0) += value.head<6>().array().square() / variance.head<6>().array();
    sums.squares.col(1) += value.tail<6>().array().square() / variance.tail<6>().array();
    sums.mean_variance += variance.head<6>().array();
    const auto middle = static_cast<Index>((first + last) / 2);
    sums.variance += c.diagonal().segment<6>(6 * middle).array();
    ++sums.lines;
    if (!means.empty()) {
      const MatrixXd difference = whole.topRows(6) - rows.back();
      const VectorXd apart = value.head<6>() - means.back();
      sums.squares.col(2) += apart.array().square() / (difference * c * difference.transpose()).diagonal().array();
      ++sums.pairs;
    }
    means.emplace_back(value.head<6>());
    rows.emplace_back(whole.topRows(6));

    std::vector<double> later{times[static_cast<size_t>(middle)]};
    for (const double lag : lags) later.push_back(later.front() + lag);
    if (later.back() > d.time.back()) continue;
    const MatrixXd l = errors.covariance(later);
    for (Index k = 0; k < static_cast<Index>(lags.size()); ++k)
      for (Index i = 0; i < 6; ++i) sums.likeness(i, k) += l(i, 6 * (k + 1) + i) / std::sqrt(l(i, i) * l(6 * (k + 1) + i, 6 * (k + 1) + i));
    ++sums.likenesses;
  }
}

/// Variance of the mean over a line of white noise through exp(-dt / tau), of its own variance.
double share_of_mean(double tau) {
  const double x = line_seconds / tau;
  return 2 / (x * x) * (x - 1 + std::exp(-x));
}
double tau_of_mean(double share) {
  double low = 1e-3, high = 1e5;
  for (int i = 0; i < 100; ++i) {
    const double middle = std::sqrt(low * high);
    (share_of_mean(middle) < share ? low : high) = middle;
  }
  return low;
}

void print(const char* grade, const Sums& s) {
  constexpr double arcsec = core::degree / 3600;
  std::printf("\n%s: %.0f lines\n%-8s %9s %6s  correlation at", grade, s.lines, "", "sigma", "tau");
  for (const double lag : lags) std::printf(" %5.0fs", lag);
  std::printf("   error / sigma: mean, slope, difference\n");
  const Eigen::Array<double, 6, 3> ratio = (s.squares.rowwise() / Eigen::Array<double, 1, 3>(s.lines, s.lines, s.pairs)).sqrt();
  for (Index i = 0; i < 6; ++i) {
    const double sigma = std::sqrt(s.variance[i] / s.lines);
    std::printf("%-8s %6.2f %s %5.0fs               ", names[static_cast<size_t>(i)], i < 3 ? 100 * sigma : sigma / arcsec,
                i < 3 ? "cm" : "as", tau_of_mean(s.mean_variance[i] / s.variance[i]));
    for (Index k = 0; k < static_cast<Index>(lags.size()); ++k) std::printf(" %6.2f", s.likeness(i, k) / s.likenesses);
    std::printf("   %.2f %.2f %.2f\n", ratio(i, 0), ratio(i, 1), ratio(i, 2));
  }
  const Eigen::Array<double, 1, 3> all = ratio.square().colwise().mean().sqrt();
  std::printf("together %.2f %.2f %.2f\n", all[0], all[1], all[2]);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) try {
  const int flights = argc > 1 ? std::max(1, std::atoi(argv[1])) : 30;
  std::printf("tau: of exp(-|dt| / tau) with the same variance of the mean over a line of %.0f s\n", line_seconds);
  for (const auto& [name, grade] : {std::pair{"tactical", core::ImuGrade::tactical}, std::pair{"compact", core::ImuGrade::compact},
                                    std::pair{"mems", core::ImuGrade::mems}}) {
    Sums sums;
    for (int k = 1; k <= flights; ++k) add(sums, grade, static_cast<std::uint64_t>(k));
    print(name, sums);
  }
  return 0;
} catch (const core::Error& e) {
  std::fprintf(stderr, "%s\n", e.text().c_str());
  return 1;
}
