// SPDX-License-Identifier: GPL-3.0-or-later
// Which mistake of centimetres to metres explains the differences of lines and of control best: a usual one, or a value of calibration that
// is off.
#pragma once

#include <string>
#include <vector>

#include "calib/geometry/small_errors.h"
#include "calib/geometry/usual_mistakes.h"

namespace swath::calib {

struct SmallExplanation {
  std::string name, what, cure;
  Chain chain;         ///< with it undone
  double gain = 0.0;   ///< of the weighted squares: a chi-square of as many degrees of freedom as values were found
  bool usual = false;  ///< a sign, a unit, an axis: nothing was fitted
  double step = 0.0;   ///< of fit_small(): change by this call beside that since the values stated
};

/// How a flight is flown, for the size of an error on the ground.
struct FlownAt {
  double range = 0.0, speed = 0.0;  ///< m, m/s
};

/// Those that explain the differences far better than the values as stated, the best first, and those as good; usually none. `errors`: of
/// the values of `at`, which may be nearer to the right ones than the stated. `heights`: there is control, which shows errors that lift all
/// lines alike. `alarmed`: control alone is off; less is enough to say what, and a height common to all lines is named beside the usual
/// mistakes.
std::vector<SmallExplanation> explain_small(const SmallErrors& errors, const Chain& at, const Chain& stated,
                                            const std::vector<UsualMistake>& usual, const FlownAt& flown, bool heights,
                                            bool alarmed = false);

/// Groups of values that are fitted to lines alone, whatever the gain.
size_t fitted_groups();
/// One of them found from `errors`, which are those of the chain `at`; named where it differs clearly from the one stated.
SmallExplanation fit_small(const SmallErrors& errors, const Chain& stated, const Chain& at, size_t group);

}  // namespace swath::calib
