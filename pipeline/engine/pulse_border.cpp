// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/pulse_border.h"

#include <numeric>

namespace swath::pipeline {
namespace {

constexpr size_t most_of_a_pulse = 255;  // return numbers are 8-bit

/// The row where the last pulse begins; the end where more records share its time than a pulse can have (a cloud without times).
size_t last_pulse(const std::vector<double>& time) {
  size_t at = time.size();
  while (at > 0 && time[at - 1] == time.back()) --at;
  return time.size() - at > most_of_a_pulse ? time.size() : at;
}

/// Cuts the columns to their first `at` rows and gives the rest.
core::Shots take_tail(core::Shots& s, size_t at) {
  core::Shots out;
  core::for_each_column(s, out, [at](auto& a, auto& b) {
    if (a.empty()) return;
    b.assign(a.begin() + static_cast<std::ptrdiff_t>(at), a.end());
    a.resize(at);
  });
  return out;
}

}  // namespace

void PulseBorder::cut(stages::StripBatch& batch, bool last) {
  if (shots_.size() > 0) {
    core::for_each_column(batch.shots, shots_, [](const auto& a, auto& b) { b.insert(b.end(), a.begin(), a.end()); });
    batch.shots = std::move(shots_);
    shots_ = {};
  }
  if (block_.size() > 0) {
    if (batch.block.size() > 0) core::append(block_, batch.block);
    batch.block = std::move(block_);
    block_ = {};
  }
  if (last) return;
  if (batch.shots.size() > 0) shots_ = take_tail(batch.shots, last_pulse(batch.shots.time));
  if (batch.block.size() > 0 && !batch.block.time.empty()) {
    const size_t at = last_pulse(batch.block.time);
    std::vector<std::uint32_t> index(batch.block.size() - at);
    std::iota(index.begin(), index.end(), static_cast<std::uint32_t>(at));
    block_ = core::select(batch.block, index);
    core::resize(batch.block, at);
  }
}

}  // namespace swath::pipeline
