// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins_report.h"
