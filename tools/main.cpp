// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/program.h"

int main(int argc, char** argv) { return swath_program(argc, argv); }
