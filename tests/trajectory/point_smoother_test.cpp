// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/point_smoother.h"

#include <gtest/gtest.h>
