// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/plan_options.h"
