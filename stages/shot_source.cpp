// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/shot_source.h"

#include <future>

#include "core/error.h"

namespace swath::stages {
namespace {

constexpr size_t batch_returns = 1 << 17;

}  // namespace

georef::ShotStream stream_shots(const Context& context) {
  if (!context.source)
    throw core::usage_error("no stage gives raw shots", context.survey.name, "readers.laser comes before the stages of calibration");
  return [&context](const std::function<void(int, const core::Shots&)>& work) {
    // What readers report of their files is reported once, where the strips are worked on or were first scanned.
    core::Tally told_elsewhere;
    for (const Strip& strip : context.strips) {
      const std::unique_ptr<StripReader> reader = context.source->open(context, strip);
      const auto read = [&] {
        StripBatch batch;
        const bool more = reader->next(batch, batch_returns, told_elsewhere);
        return std::pair(std::move(batch), more);
      };
      for (auto next = std::async(std::launch::async, read); next.valid();) {
        auto [batch, more] = next.get();
        if (more) next = std::async(std::launch::async, read);
        if (batch.shots.size() > 0) work(strip.line, batch.shots);
      }
    }
  };
}

}  // namespace swath::stages
