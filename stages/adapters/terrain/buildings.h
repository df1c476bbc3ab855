// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "stages/entry.h"

namespace swath::stages {

Entry buildings_stage();

}  // namespace swath::stages
