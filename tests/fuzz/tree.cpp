// SPDX-License-Identifier: GPL-3.0-or-later
// TOML and JSON: surveys, calibrations, hangar surveys, and any other tree, which must come back the same from its own text.
#include "core/error.h"
#include "io/survey/calibration_file.h"
#include "io/survey/hangar_file.h"
#include "io/survey/info.h"
#include "io/survey/read_survey.h"
#include "io/text/value_file.h"
#include "tests/fuzz/target.h"

using namespace swath;

namespace {

void expect_same_again(const core::Value& tree) {
  const std::string text = io::to_json(tree);
  std::string again;
  try {
    again = io::to_json(io::parse_json(text, "again"));
  } catch (const core::Error& e) {
    again = e.text();
  }
  if (again != text) fuzz::expect(1, 0, "the difference between a tree and what is read back");
}

void read_calibration(const std::filesystem::path& file) {
  core::Calibration calibration;
  core::SensorSigma sigma;
  io::load_calibration(file, calibration, sigma);
  fuzz::expect(calibration.roll.value, 1e9, "a boresight angle");
  fuzz::expect(calibration.range_scale, 1e9, "a scale");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  fuzz::reading([&] { expect_same_again(io::parse_toml(text, "input")); });
  fuzz::reading([&] { expect_same_again(io::parse_json(text, "input")); });
  for (const char* name : {"tree.toml", "tree.json"}) {
    const auto file = fuzz::given(name, data, size);
    fuzz::reading([&] { io::read_survey(file); });
    fuzz::reading([&] { io::read_hangar(file); });
    fuzz::reading([&] { read_calibration(file); });
    fuzz::reading([&] { io::info_text(io::describe_file(file)); });
  }
  return 0;
}
