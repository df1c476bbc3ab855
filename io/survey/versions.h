// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/config/value.h"

namespace swath::io {

/// Names and versions of the libraries behind this room's doors.
core::Value library_versions();

}  // namespace swath::io
