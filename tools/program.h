// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// The whole program: what `main` is of the executable. Seen from outside of a shared library, so that the Python module of a wheel can
/// hold the program's code and the wheel's executable is a launcher of it (python/launcher.cpp). Returns the exit code.
extern "C" __attribute__((visibility("default"))) int swath_program(int argc, char** argv);
