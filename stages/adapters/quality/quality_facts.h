// SPDX-License-Identifier: GPL-3.0-or-later
// What the quality stages before report.quality have left, as its page and its XML read it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/value.h"
#include "quality/quality_level.h"
#include "stages/adapters/quality/quality_sheet.h"
#include "stages/stage.h"

namespace swath::stages {

/// A table of findings; empty where the stage did not run.
class Facts {
 public:
  Facts() = default;
  explicit Facts(core::Value v) : value_(std::move(v)) {}
  bool any() const { return value_.is_object(); }
  /// Not a number where there is none.
  double number(std::string_view key) const;
  std::optional<double> known(std::string_view key) const;  ///< nothing where there is no finite number
  std::string text(std::string_view key) const;             ///< empty where there is none
  bool holds(std::string_view key) const;                   ///< is it there, and true?
  std::vector<Facts> list(std::string_view key) const;
  Facts table(std::string_view key) const;
  std::vector<double> numbers(std::string_view key) const;
  std::vector<std::string> texts(std::string_view key) const;

 private:
  core::Value value_{};
};

struct QualityFacts {
  std::string survey, crs, heights;
  std::string unit = "m";  ///< of places on the map, as core::unit_symbol() has it
  double metres = 1.0;     ///< of one such unit
  Facts density, swath, lines, surface, points;
  std::string level = "none";
  std::vector<quality::Requirement> requirements{};
  std::vector<std::string> not_judged{};                                                  ///< sentences
  std::filesystem::path density_map{}, overlap_map{}, distribution_map{}, surface_map{};  ///< empty: there is none
  size_t missed() const;
  size_t judged() const;
};

/// Reads what the stages before have made.
QualityFacts quality_facts(const Context& context, const quality::StatedLimits& stated);

/// quality.html, one self-contained file, and quality.pdf.
QualitySheet quality_page(const QualityFacts& facts);

/// ISO 19157-2 XML: DQ_DataQuality with a report for each measure, quantitative and conformance results.
std::string quality_xml(const QualityFacts& facts);

}  // namespace swath::stages
