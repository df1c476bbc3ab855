// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a calibration report of made-up numbers into a folder, for the checks of its page.
#include <cstdio>
#include <exception>
#include <string>

#include "tests/calib/report/made_report.h"

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fputs("usage: calibration_sample FOLDER whole|refused\n", stderr);
    return 2;
  }
  swath::calib::write_calibration_report(swath::calib::made_report(std::string(argv[2]) == "refused"), argv[1]);
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
