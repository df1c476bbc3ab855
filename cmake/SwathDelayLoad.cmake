# SPDX-License-Identifier: GPL-3.0-or-later
# A shared library that is loaded at the first call of one of its functions and not at the start of the program, as linkers of other systems do it
# (/DELAYLOAD). GDAL brings some hundred libraries with it, and the linker's work on them is most of the time that `swath --help` would take.
#
#   swath_delay_load(swath_io gdal /usr/lib/x86_64-linux-gnu/libgdal.so)
#
# What of the library `target` (static) calls gets an entry in a generated file: a jump through a slot that the first call of any of them fills
# (io/vector/delayed_library.h). Only functions can be delayed; data of the library used by `target` is a fault of the build.
enable_language(ASM)
function(swath_delay_load target name library)
  set(stubs ${CMAKE_CURRENT_BINARY_DIR}/${name}_delayed.s)
  add_custom_command(OUTPUT ${stubs}
    COMMAND ${CMAKE_COMMAND} -DNAME=${name} -DLIBRARY=${library} -DOBJECTS=$<TARGET_FILE:${target}> -DNM=${CMAKE_NM} -DREADELF=${CMAKE_READELF}
            -DOUTPUT=${stubs} -P ${PROJECT_SOURCE_DIR}/cmake/delayed_stubs.cmake
    DEPENDS ${target} ${PROJECT_SOURCE_DIR}/cmake/delayed_stubs.cmake VERBATIM)
  add_library(${target}_${name} STATIC ${stubs})
  # The stubs call the loader within `target`, which calls them.
  target_link_libraries(${target}_${name} INTERFACE ${target} ${CMAKE_DL_LIBS})
  target_link_libraries(${target} INTERFACE ${target}_${name})
  set_property(GLOBAL APPEND PROPERTY swath_rooms ${target}_${name})
endfunction()
