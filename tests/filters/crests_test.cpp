// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/crests.h"

#include <gtest/gtest.h>
