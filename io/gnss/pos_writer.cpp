// SPDX-License-Identifier: GPL-3.0-or-later
// RTKLIB 2.4.2 manual, appendix B.1.
#include "io/gnss/pos_writer.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "core/time.h"
#include "io/text/binary_file.h"
#include "io/text/output_file.h"

namespace swath::io {
namespace {

constexpr double finest_time = 1e-6;  // s, the last digit written

/// RTKLIB's number of a kind of solution, by core::FixQuality; it has none for `unknown`, which counts as single.
constexpr std::array<int, 7> numbers = {5, 1, 2, 6, 4, 3, 5};

double signed_root(double covariance) { return std::copysign(std::sqrt(std::abs(covariance)), covariance); }

}  // namespace

void write_pos(const std::filesystem::path& file, const core::GnssData& fixes, const std::vector<std::string>& remarks) {
  OutputFile out(file);
  BinaryAppender to(out.temporary(), file);
  std::string text;
  for (const std::string& r : remarks) text += "% " + r + "\n";
  text +=
      "%\n% (x/y/z-ecef=WGS84,Q=1:fix,2:float,3:sbas,4:dgps,5:single,6:ppp,ns=# of satellites)\n"
      "%  GPST                 x-ecef(m)      y-ecef(m)      z-ecef(m)   Q  ns   sdx(m)   sdy(m)   sdz(m)  sdxy(m)  sdyz(m)  sdzx(m)\n";
  char line[256];
  for (size_t i = 0; i < fixes.size(); ++i) {
    // Rounded first, so that the last instant of a week becomes the first of the next.
    const double time = std::round(fixes.time[i] / finest_time) * finest_time;
    const Eigen::Vector3d& p = fixes.position[i];
    const Eigen::Matrix3d& c = fixes.covariance[i];
    const int length =
        std::snprintf(line, sizeof line, "%4d %13.6f %14.4f %14.4f %14.4f %3d %3d %8.4f %8.4f %8.4f %8.4f %8.4f %8.4f\n",
                      core::week_of(time), core::seconds_of_week(time), p.x(), p.y(), p.z(), numbers[static_cast<size_t>(fixes.quality[i])],
                      static_cast<int>(fixes.satellites[i]), std::sqrt(c(0, 0)), std::sqrt(c(1, 1)), std::sqrt(c(2, 2)),
                      signed_root(c(0, 1)), signed_root(c(1, 2)), signed_root(c(0, 2)));
    text.append(line, static_cast<size_t>(length));
    if (text.size() > (1 << 20)) {
      to.append(text.data(), text.size());
      text.clear();
    }
  }
  to.append(text.data(), text.size());
  to.close();
  out.commit();
}

}  // namespace swath::io
