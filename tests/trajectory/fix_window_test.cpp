// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/fix_window.h"

#include <gtest/gtest.h>
