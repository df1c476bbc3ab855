# SPDX-License-Identifier: GPL-3.0-or-later
# Writes OUTPUT, assembly: a place for each name that MODULE, a Python module, takes from the interpreter, so that a program which is not one can load
# the module (python/launcher.cpp). The loader wants an address for all of them; the program reads and calls none.
cmake_minimum_required(VERSION 3.22)
execute_process(COMMAND ${NM} -D --undefined-only ${MODULE} OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "U _?Py[A-Za-z0-9_]+" taken "${text}")
if(NOT taken)
  message(FATAL_ERROR "${MODULE} takes nothing from Python")
endif()
list(TRANSFORM taken REPLACE "U (.+)" "\t.globl \\1\n\\1:\n")
list(JOIN taken "" names)
file(WRITE ${OUTPUT} "# Made by cmake/python_names.cmake\n\t.section .rodata\n\t.balign 8\n${names}\t.quad 0\n\t.section .note.GNU-stack,\"\"\n")
