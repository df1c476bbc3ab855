// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "stages/stage.h"

namespace swath::pipeline {

/// Moves the border of batches to the border of pulses: the records at a batch's end that share its last time wait for the next one.
class PulseBorder {
 public:
  /// Puts what waited in front; holds back the last pulse unless `last`.
  void cut(stages::StripBatch& batch, bool last);

 private:
  core::Shots shots_;
  core::Block block_;
};

}  // namespace swath::pipeline
