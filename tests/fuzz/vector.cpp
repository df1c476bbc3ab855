// SPDX-License-Identifier: GPL-3.0-or-later
// Vector files behind GDAL: breaklines, areas, contour lines, control points. GDAL itself reports no coverage.
#include "io/vector/vector.h"

#include <cmath>

#include "io/vector/breaklines.h"
#include "io/vector/describe_vector.h"
#include "io/vector/side_files.h"
#include "tests/fuzz/target.h"

using namespace swath;

namespace {

void read_breaklines(const io::Survey& survey) {
  core::Tally tally;
  for (const core::Breakline& line : io::read_breaklines(survey, survey.crs, tally))
    for (const auto& part : line.parts)
      for (const Eigen::Vector3d& p : part) fuzz::expect(p.norm(), 1e300, "a vertex of a breakline");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // GDAL opens some formats under their own endings alone.
  const std::string start(reinterpret_cast<const char*>(data), std::min<std::size_t>(size, 15));
  const std::string name = start == "SQLite format 3" ? "lines.gpkg" : start.starts_with("{") ? "lines.geojson" : "lines.dxf";
  const auto file = fuzz::given(name, data, size);
  for (const char* kind : {"breakline", "lake"}) {
    io::Survey survey;
    survey.crs = "EPSG:32632";
    survey.folder = fuzz::folder();
    survey.breaklines.resize(1);
    survey.breaklines[0].file = file;
    survey.breaklines[0].kind = *kind == 'b' ? core::BreaklineKind::breakline : core::BreaklineKind::lake;
    fuzz::reading([&] { read_breaklines(survey); });
  }
  fuzz::reading([&] {
    for (const io::VectorLine& line : io::read_lines(file).lines)
      for (std::size_t i = 0; i < line.x.size(); ++i) {
        fuzz::expect(line.x[i], 1e300, "an x of a line");
        fuzz::expect(line.y[i], 1e300, "a y of a line");
      }
  });
  fuzz::reading([&] { io::describe_vector(file); });
  fuzz::reading([&] { io::side_files(file); });
  std::filesystem::remove(file);
  return 0;
}
