// SPDX-License-Identifier: GPL-3.0-or-later
// What the sections of the quality page are made of, and those about marks and references.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/html.h"
#include "stages/adapters/quality/quality_facts.h"

namespace swath::stages {

/// A column of a table of facts: its head, the key, and decimals (below 0: a text; 0 and more: a number).
struct FactColumn {
  std::string head, key;
  int decimals = 3;
  double scale = 1.0;
};

/// A row for each of the facts.
report::Table fact_table(const std::string& caption, const std::vector<FactColumn>& columns, const std::vector<Facts>& rows);
/// Nothing where there is no such file.
void add_map(QualitySheet& page, const std::filesystem::path& file, const std::string& caption);
/// The differences `bins_m` and `bin_cells` as columns of equal width.
void add_histogram(QualitySheet& page, const Facts& from, const std::string& x_label, const std::string& caption);

// Sections of what is compared with marks, roofs and a reference; nothing where the stage did not run.
void add_check_points(QualitySheet& page, const QualityFacts& facts);
void add_roofs(QualitySheet& page, const QualityFacts& facts);
void add_surface(QualitySheet& page, const QualityFacts& facts);

}  // namespace swath::stages
