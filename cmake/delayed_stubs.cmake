# SPDX-License-Identifier: GPL-3.0-or-later
# Writes OUTPUT, assembly for x86-64: a jump through a slot for each function of LIBRARY that OBJECTS call (see SwathDelayLoad.cmake).
cmake_minimum_required(VERSION 3.22)
function(symbols_of out)
  execute_process(COMMAND ${NM} ${ARGN} OUTPUT_VARIABLE text ERROR_QUIET RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "nm ${ARGN} failed")
  endif()
  string(REPLACE "\n" ";" lines "${text}")
  set(${out} "${lines}" PARENT_SCOPE)
endfunction()

execute_process(COMMAND ${READELF} -d ${LIBRARY} OUTPUT_VARIABLE dynamic RESULT_VARIABLE failed)
if(failed OR NOT dynamic MATCHES "SONAME[^[]*\\[([^]]+)\\]")
  message(FATAL_ERROR "${LIBRARY} is not a shared library with a name of its own")
endif()
set(soname ${CMAKE_MATCH_1})

symbols_of(exported -D --defined-only ${LIBRARY})
foreach(line IN LISTS exported)
  if(line MATCHES "^[0-9a-f]+ ([A-Za-z]) ([^@]+)")
    set(kind_${CMAKE_MATCH_2} ${CMAKE_MATCH_1})
  endif()
endforeach()

symbols_of(called -u ${OBJECTS})
list(FILTER called INCLUDE REGEX "^ +U ")
list(REMOVE_DUPLICATES called)
list(SORT called)
set(count 0)
foreach(line IN LISTS called)
  string(REGEX REPLACE "^ +U ([^@ ]+).*" "\\1" symbol "${line}")
  if(NOT DEFINED kind_${symbol})
    continue()
  endif()
  if(kind_${symbol} STREQUAL "W" OR kind_${symbol} STREQUAL "V")
    continue()  # an inline function or a template of others, which the objects hold themselves
  endif()
  if(NOT kind_${symbol} STREQUAL "T")
    message(FATAL_ERROR "${symbol} of ${LIBRARY} is data, which cannot be delayed: build with -DSWATH_DELAY_GDAL=OFF")
  endif()
  string(APPEND stubs "\t.globl ${symbol}\n\t.hidden ${symbol}\n\t.type ${symbol}, @function\n${symbol}:\n\tjmp *slots+8*${count}(%rip)\n"
    "\t.size ${symbol}, .-${symbol}\nfirst_${count}:\n\tpushq $${count}\n\tjmp load\n")
  string(APPEND slots "\t.quad first_${count}\n")
  string(APPEND names "\t.quad name_${count}\n")
  string(APPEND texts "name_${count}:\t.asciz \"${symbol}\"\n")
  math(EXPR count "${count} + 1")
endforeach()
if(count EQUAL 0)
  message(FATAL_ERROR "${OBJECTS} calls nothing of ${LIBRARY}")
endif()

# `load` keeps every register that holds arguments (System V ABI, x86-64, 3.2.3), has all slots filled and goes on to the function. An exception of
# the loader passes through it to the caller: hence the frame's description. The note says to packagers which library will be loaded (ELF dlopen
# metadata of the UAPI group, https://uapi-group.org/specifications/specs/elf_dlopen_metadata/).
file(WRITE ${OUTPUT}.new "# Made by cmake/delayed_stubs.cmake
\t.text
${stubs}
load:
\t.cfi_startproc
\t.cfi_def_cfa_offset 16
\tpushq %rbp
\t.cfi_def_cfa_offset 24
\t.cfi_offset %rbp, -24
\tmovq %rsp, %rbp
\t.cfi_def_cfa_register %rbp
\tsubq $192, %rsp
\tandq $-16, %rsp
\tmovups %xmm0, (%rsp)
\tmovups %xmm1, 16(%rsp)
\tmovups %xmm2, 32(%rsp)
\tmovups %xmm3, 48(%rsp)
\tmovups %xmm4, 64(%rsp)
\tmovups %xmm5, 80(%rsp)
\tmovups %xmm6, 96(%rsp)
\tmovups %xmm7, 112(%rsp)
\tmovq %rdi, 128(%rsp)
\tmovq %rsi, 136(%rsp)
\tmovq %rdx, 144(%rsp)
\tmovq %rcx, 152(%rsp)
\tmovq %r8, 160(%rsp)
\tmovq %r9, 168(%rsp)
\tmovq %rax, 176(%rsp)
\tmovq %r10, 184(%rsp)
\tleaq library(%rip), %rdi
\tleaq names(%rip), %rsi
\tleaq slots(%rip), %rdx
\tmovl $${count}, %ecx
\tcall swath_load_delayed
\tmovups (%rsp), %xmm0
\tmovups 16(%rsp), %xmm1
\tmovups 32(%rsp), %xmm2
\tmovups 48(%rsp), %xmm3
\tmovups 64(%rsp), %xmm4
\tmovups 80(%rsp), %xmm5
\tmovups 96(%rsp), %xmm6
\tmovups 112(%rsp), %xmm7
\tmovq 128(%rsp), %rdi
\tmovq 136(%rsp), %rsi
\tmovq 144(%rsp), %rdx
\tmovq 152(%rsp), %rcx
\tmovq 160(%rsp), %r8
\tmovq 168(%rsp), %r9
\tmovq 176(%rsp), %rax
\tmovq 184(%rsp), %r10
\tmovq %rbp, %rsp
\tpopq %rbp
\t.cfi_def_cfa %rsp, 16
\tpopq %r11
\t.cfi_def_cfa_offset 8
\tpushq %rbx
\tleaq slots(%rip), %rbx
\tmovq (%rbx,%r11,8), %r11
\tpopq %rbx
\tjmp *%r11
\t.cfi_endproc
\t.section .data.rel,\"aw\",@progbits
\t.balign 8
slots:
${slots}
\t.section .data.rel.ro,\"aw\",@progbits
\t.balign 8
names:
${names}
\t.section .rodata
library:\t.asciz \"${soname}\"
${texts}
\t.section .note.dlopen,\"a\",@note
\t.balign 4
\t.long 4, note_end-note_begin, 0x407c0c0a
\t.asciz \"FDO\"
note_begin:\t.asciz \"[{\\\"feature\\\":\\\"${NAME}\\\",\\\"priority\\\":\\\"required\\\",\\\"soname\\\":[\\\"${soname}\\\"]}]\"
note_end:
\t.balign 4
\t.section .note.GNU-stack,\"\",@progbits
")
file(RENAME ${OUTPUT}.new ${OUTPUT})
