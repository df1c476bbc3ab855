// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "stages/entry.h"

namespace swath::stages {

Entry copc_writer_stage();

}  // namespace swath::stages
