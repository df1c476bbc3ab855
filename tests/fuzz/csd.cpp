// SPDX-License-Identifier: GPL-3.0-or-later
// Optech CSD: header, pulses, the carrier's poses, and shots.
#include "io/records/csd.h"
#include "io/survey/calibration_file.h"

#include "io/records/trajectory_file.h"
#include "io/survey/info.h"
#include "tests/fuzz/target.h"

using namespace swath;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::given("flight.csd", data, size);
  static const io::Survey survey = fuzz::survey_of("[[laser]]\nfile = \"flight.csd\"\n");
  fuzz::reading([&] { io::describe_file(file); });
  fuzz::reading([&] { fuzz::read_shots(survey); });
  fuzz::reading([&] {
    core::Tally tally;
    fuzz::expect_sound(io::read_trajectory(survey, tally));
  });
  fuzz::reading([&] {
    core::Calibration calibration;
    core::SensorSigma sigma;
    io::load_calibration(file, calibration, sigma);
    fuzz::expect(calibration.roll.value, 1e9, "a boresight angle");
  });
  return 0;
}
