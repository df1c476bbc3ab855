// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace swath::core {

/// What usually sets two records that belong together so many seconds apart, for a hint: whole weeks, whole days, the epochs of time
/// scales. Empty where it looks like none of them. `length`: s, of both records together; gaps that are not sharp against it are not named.
std::string usual_time_gap(double apart, double length);

}  // namespace swath::core
