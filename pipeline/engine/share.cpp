// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/share.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <numeric>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "io/text/output_file.h"

namespace swath::pipeline {

using stages::Grain;

std::vector<Wave> waves_of(const Plan& plan) {
  std::vector<Wave> waves{{WaveKind::survey, 0}};
  if (makes_points(plan)) {
    waves.push_back({WaveKind::strips, 0});
    size_t last_strip_stage = 0;
    for (size_t i = 0; i < plan.stages.size(); ++i)
      if (plan.stages[i].stage->works_on(Grain::strip)) last_strip_stage = i;
    for (size_t i = last_strip_stage + 1; i < plan.stages.size(); ++i)
      if (plan.works_on(i, Grain::tile)) waves.push_back({WaveKind::tiles, i});
  }
  waves.push_back({WaveKind::finish, 0});
  return waves;
}

std::string name_of(const Plan& plan, const Wave& wave) {
  switch (wave.kind) {
    case WaveKind::survey:
      return "survey";
    case WaveKind::strips:
      return "strips";
    case WaveKind::tiles:
      return std::string(plan.stages[wave.stage].stage->info().name);
    case WaveKind::finish:
      return "finish";
  }
  return "";
}

Share read_share(size_t wave, const std::string& part) {
  Share out{wave, 0, 0, {}};
  const char* end = part.data() + part.size();
  const auto first = std::from_chars(part.data(), end, out.part);
  const bool has_slash = first.ec == std::errc() && first.ptr != end && *first.ptr == '/';
  const auto second = has_slash ? std::from_chars(first.ptr + 1, end, out.parts) : std::from_chars_result{end, std::errc::invalid_argument};
  if (second.ec != std::errc() || second.ptr != end || out.part < 1 || out.part > out.parts || out.parts > max_parts)
    throw core::usage_error("'" + part + "' is not a part", "--part", "write it as i/n, from 1/n to n/n, n at most 100000: --part 2/8");
  return out;
}

std::vector<bool> pieces_of(const std::vector<double>& work, int part, int parts) {
  std::vector<size_t> order(work.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return work[a] > work[b]; });
  std::vector<double> load(static_cast<size_t>(parts), 0.0);
  std::vector<bool> mine(work.size(), false);
  for (const size_t piece : order) {
    const auto least = std::min_element(load.begin(), load.end());
    *least += work[piece];
    mine[piece] = least - load.begin() == part - 1;
  }
  return mine;
}

PieceLock::PieceLock(const std::filesystem::path& piece) : fd_(-1) {
  const std::filesystem::path file = piece.parent_path() / "pieces.lock";
  std::error_code ec;
  std::filesystem::create_directories(file.parent_path(), ec);
  if (ec) io::throw_system_error("cannot make the folder", file.parent_path(), ec.value());
  fd_ = ::open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (fd_ < 0) io::throw_system_error("cannot write", file, errno);
  // Two names with the same byte would wait for one another, and no more.
  struct flock byte {};
  byte.l_type = F_WRLCK;
  byte.l_whence = SEEK_SET;
  byte.l_start = static_cast<off_t>(core::fnv1a(piece.filename().string()) >> 2);
  byte.l_len = 1;
  while (::fcntl(fd_, F_OFD_SETLKW, &byte))
    if (errno != EINTR) {
      const int code = errno;
      ::close(fd_);
      io::throw_system_error("cannot lock", file, code);
    }
}

PieceLock::~PieceLock() { ::close(fd_); }

}  // namespace swath::pipeline
