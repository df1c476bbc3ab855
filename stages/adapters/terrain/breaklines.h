// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <mutex>

#include "stages/stage.h"
#include "terrain/water/breaklines.h"

namespace swath::stages {

/// The breaklines that terrain.breaklines has settled, ready for any tile; null where the plan has no such stage.
std::unique_ptr<terrain::Breaklines> settled_breaklines(const Context& context);

/// The same for all tiles of a stage: read by the first that asks.
class BreaklinesOfRun {
 public:
  const terrain::Breaklines* get(const Context& context) const {
    std::call_once(once_, [&] { lines_ = settled_breaklines(context); });
    return lines_.get();
  }

 private:
  mutable std::once_flag once_;
  mutable std::unique_ptr<const terrain::Breaklines> lines_;
};

}  // namespace swath::stages
