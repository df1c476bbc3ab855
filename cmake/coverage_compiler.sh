#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# coverage_compiler.sh COMPILER ARGUMENT...: compiles without counting the lines of the libraries' headers.
exec "$@" "-fprofile-exclude-files=^/usr/include/.*;^/usr/lib/.*"
