// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace swath::filters {

/// From the first call on PCL prints nothing (its messages report samples that fit no model, which is no fault here). Its level is one
/// variable of the process, unguarded, so it is written once however many threads call.
void silence_pcl();

}  // namespace swath::filters
