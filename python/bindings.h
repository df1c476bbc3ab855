// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of the module swath._swath. The package in python/swath wraps them; they are not for users.
#pragma once

#include <nanobind/nanobind.h>

namespace swath::python {

void bind_las_files(nanobind::module_& m);
void bind_arrow(nanobind::module_& m);
void bind_runs(nanobind::module_& m);
void bind_declared(nanobind::module_& m);
void bind_other_files(nanobind::module_& m);

}  // namespace swath::python
