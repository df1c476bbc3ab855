// SPDX-License-Identifier: GPL-3.0-or-later
// The noise of fixes and IMU as the innovations of a pass show it.
#pragma once

#include <functional>
#include <vector>

#include "trajectory/ins/ins_problem.h"

namespace swath::trajectory {

constexpr double largest_share = 0.95;  ///< of the GNSS variance that may be found correlated
constexpr double usual_share = 0.4;     ///< of the GNSS variance that is correlated, where nothing determines it

/// Sets share and variance of the fixes to what the innovations show: their excess (nis / 3 - 1) S over what was expected belongs to the
/// white part R. White noise above the stated variance raises that. True where they changed by more than noise.
bool adapt_fixes(Problem& problem, const std::vector<FixOutcome>& outcomes);

/// How many times larger the stated sigmas of the fixes are than what fits the innovations best; 1 where those do not decide it, or the
/// white part alone is most of what is stated. `pass`: the outcomes with the share and variance of the problem that it is given.
/// White noise is known by adapt_fixes; what is left of the stated variance counts as correlated, and is halved as long as the innovations
/// become more probable. Errors that change far more slowly than correlation_time look like small ones.
double overstatement(const Problem& problem, const std::function<std::vector<FixOutcome>(const Problem&)>& pass);

/// Doubles the IMU's noise where the innovations are too large and follow one another: more motion than the IMU shows, as under
/// vibration. (White noise of the fixes makes them large too, but not alike.) True where it did.
bool adapt_imu(Problem& problem, const std::vector<FixOutcome>& outcomes);

}  // namespace swath::trajectory
