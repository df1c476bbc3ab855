// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of check points that are read, and what quality.points leaves of every one: a table and a layer of a map.
#pragma once

#include <string>
#include <vector>

#include "quality/check_marks.h"
#include "stages/adapters/quality/mark_accuracy.h"
#include "stages/stage.h"

namespace swath::stages {

/// A file of check points and the columns taken from it, by name or by number from 1.
struct CheckFileRead {
  std::string file, name, x, y, z;
};
template <class V>
void describe(const CheckFileRead& r, V& v) {
  v.result("file", r.file, "File.");
  v.result("name", r.name, "Column of the names.");
  v.result("x", r.x, "Column of the eastings.");
  v.result("y", r.y, "Column of the northings.");
  v.result("z", r.z, "Column of the heights.");
}

/// Does the file hold check points, which have three coordinates?
bool holds_check_points(const io::ControlFile& file);

/// Those of the survey; GeoPackages have no columns to choose.
std::vector<CheckFileRead> tables_read(const io::Survey& survey);

/// NAME.csv and NAME.gpkg.
void write_marks(const Context& context, const std::string& name, const std::vector<quality::CheckMark>& marks,
                 const std::vector<MarkFound>& found, const std::vector<quality::MarkReading>& readings);

}  // namespace swath::stages
