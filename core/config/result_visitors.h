// SPDX-License-Identifier: GPL-3.0-or-later
// What is made from the describe() of a struct of results: report.json, counts of a stage, documentation, JSON Schema.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "core/report.h"

namespace swath::core {

/// Something to be visited: usually [&](ResultVisitor& v) { describe(results, v); }.
using DescribeResults = std::function<void(ResultVisitor&)>;

/// A DescribeResults of one struct, which must outlive it.
template <Reported S>
DescribeResults described_results(const S& results) {
  return [&results](ResultVisitor& v) { describe(results, v); };
}

/// The results as report.json holds them.
Value reported(const DescribeResults& d);
template <Reported S>
Value reported(const S& results) {
  return reported(described_results(results));
}

/// Counts the integers among the results, each under its key.
void count_results(const DescribeResults& d, Tally& tally);
template <Reported S>
void count_results(const S& results, Tally& tally) {
  count_results(described_results(results), tally);
}

/// One result as documentation and texts show it.
struct ResultDoc {
  std::string path;  ///< "rms_m", "fit.cells", "pairs[].median_m", "checks.*.value"
  std::string shape;
  Form form;
  Fate fate = Fate::none;
  std::string doc;
  bool is_table = false;
};
std::vector<ResultDoc> document_results(const DescribeResults& d);

/// The table of results of a docs page, GitHub Markdown.
std::string result_table_markdown(const DescribeResults& d);

/// JSON Schema (2020-12) of the results. Keys beyond those declared are allowed: a later version may add some.
Value result_schema(const DescribeResults& d);

/// A number as a text shows it: rounded to the form's decimals, with its unit.
std::string shown(const Value& number, const Form& form);

}  // namespace swath::core
