// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/calibration_file.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/config/option_visitors.h"
#include "core/config/result_visitors.h"
#include "core/printable.h"
#include "io/records/csd.h"
#include "io/text/value_file.h"

namespace swath::io {
namespace {

using core::Fault;
using core::Value;

/// {"parameters": [names], "matrix": [rows]} over all calibration values; those that are not named are correlated with nothing.
std::vector<double> read_correlation(const Value& table, const std::filesystem::path& file) {
  constexpr size_t n = core::calibration_keys.size();
  const auto wrong = [&](const std::string& what) {
    return core::usage_error(
        "correlation: " + what, file.string(),
        "the table that calib.adjust writes: parameters, a list of names, and matrix, a row for each; or leave it out");
  };
  const Value* names = table.is_object() ? table.find("parameters") : nullptr;
  const Value* rows = table.is_object() ? table.find("matrix") : nullptr;
  if (!names || !rows || !names->is_array() || !rows->is_array() || names->items().size() != rows->items().size())
    throw wrong("needs parameters and a matrix with as many rows");
  std::vector<size_t> place;
  for (const Value& name : names->items()) {
    const auto at = name.is_text() ? std::find(core::calibration_keys.begin(), core::calibration_keys.end(), name.as_text())
                                   : core::calibration_keys.end();
    if (at == core::calibration_keys.end()) throw wrong("a parameter that is not a calibration value");
    place.push_back(static_cast<size_t>(at - core::calibration_keys.begin()));
  }
  std::vector<double> out(n * n, 0.0);
  for (size_t k = 0; k < n; ++k) out[k * n + k] = 1.0;
  for (size_t i = 0; i < place.size(); ++i) {
    const Value& row = rows->items()[i];
    if (!row.is_array() || row.items().size() != place.size()) throw wrong("row " + std::to_string(i + 1) + " has another length");
    for (size_t j = 0; j < place.size(); ++j) {
      const Value& v = row.items()[j];
      if (!v.is_number() || !(std::abs(v.as_number()) <= 1.0 + 1e-9))
        throw wrong("row " + std::to_string(i + 1) + " is not within -1 to 1");
      if (place[i] != place[j]) out[place[i] * n + place[j]] = v.as_number();
    }
  }
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < i; ++j)
      if (std::abs(out[i * n + j] - out[j * n + i]) > 1e-6) throw wrong("the matrix is not symmetric");
  return out;
}

/// The table that read_correlation() reads.
struct Correlation {
  std::vector<std::string> parameters;
  Eigen::MatrixXd matrix;
};

template <class V>
void describe(const Correlation& r, V& v) {
  v.result("parameters", r.parameters, "Calibration values, in the order of the matrix.");
  v.result("matrix", r.matrix, "Correlations of their errors, row by row.");
}

}  // namespace

void note_stated(const Value& table, core::SensorSigma& sigma) {
  for (const auto& [key, value] : table.members())
    if (!value.is_null() && std::find(sigma.stated.begin(), sigma.stated.end(), key) == sigma.stated.end()) sigma.stated.push_back(key);
}

void load_calibration(const std::filesystem::path& file, core::Calibration& calibration, core::SensorSigma& sigma) {
  if (core::lower_case(file.extension().string()) == ".csd") {
    const core::Calibration header = calibration_of(CsdReader(file).header());
    for (const core::Radians angle : {header.roll, header.pitch, header.heading})
      if (!(std::abs(angle.value) <= 2 * core::pi))
        throw core::Error("the header states a boresight angle of " + core::format_number(core::to_degrees(angle), 6) + " deg",
                          file.string(), "the file is damaged: export it again");
    calibration.roll = header.roll;
    calibration.pitch = header.pitch;
    calibration.heading = header.heading;
    return;
  }
  const Value tree = read_value_file(file);
  std::vector<Fault> faults;
  if (!tree.is_object()) throw core::usage_error("is no table of calibration values", file.string());
  const Value* nested = tree.find("calibration");
  const Value* sigmas = tree.find("sigma");
  core::read_options(core::described(calibration), nested ? *nested : tree, nested ? "calibration" : "", faults,
                     nested ? std::vector<std::string>{} : std::vector<std::string>{"sigma"});
  if (sigmas) core::read_options(core::described(sigma), *sigmas, "sigma", faults);
  core::throw_if_any(faults);
  if (sigmas) note_stated(*sigmas, sigma);
  sigma.correlation.clear();  // those of another calibration
  if (const Value* correlation = tree.find("correlation")) sigma.correlation = read_correlation(*correlation, file);
}

core::Value calibration_tree(const core::Calibration& calibration, const core::SensorSigma& sigma) {
  constexpr size_t n = core::calibration_keys.size();
  core::Calibration c = calibration;
  core::SensorSigma s = sigma;
  Value::Object out{{"calibration", core::effective_values(core::described(c))}, {"sigma", core::effective_values(core::described(s))}};
  if (s.correlation.size() == n * n)
    out.emplace_back("correlation", core::reported(Correlation{{core::calibration_keys.begin(), core::calibration_keys.end()},
                                                               Eigen::MatrixXd::Map(s.correlation.data(), n, n).transpose()}));
  return out;
}

}  // namespace swath::io
