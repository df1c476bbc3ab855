# SPDX-License-Identifier: GPL-3.0-or-later
# A room is one static library. Each unit is three files: ROOM/x.h, ROOM/x.cpp, tests/ROOM/x_test.cpp.
#
#   swath_room(filters UNITS smrf noise USES core LIBRARIES some::target)
#
# USES are rooms (public), LIBRARIES third parties (private: they stay behind the .cpp files),
# PUBLIC_LIBRARIES those that the room's headers show.
add_library(swath_settings INTERFACE)
target_compile_features(swath_settings INTERFACE cxx_std_20)
target_compile_options(swath_settings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Wold-style-cast
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # GCC 12 reports string + string falsely (GCC bug 105651)
  # Where a folder's units are one file these warn of what is no fault in each of them.
  $<$<BOOL:${SWATH_UNITY}>:-Wno-shadow> $<$<AND:$<BOOL:${SWATH_UNITY}>,$<CXX_COMPILER_ID:GNU>>:-Wno-subobject-linkage>
  # Not built with GCC 13 or newer yet: its guesses about lifetimes and bounds do not refuse the build.
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_GREATER_EQUAL:$<CXX_COMPILER_VERSION>,13>>:-Wno-dangling-reference>
  -ffp-contract=off $<$<BOOL:${SWATH_WERROR}>:-Werror>
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_GREATER_EQUAL:$<CXX_COMPILER_VERSION>,13>>:-Wno-error=array-bounds;-Wno-error=stringop-overflow;-Wno-error=stringop-overread;-Wno-error=maybe-uninitialized>)
if(SWATH_SANITIZE)
  # With sanitizers GCC 12 sees uninitialised members in std::optional and std::regex (GCC bugs 80635, 105562).
  # Checks of every pointer before its use treble the time to compile Eigen; the address sanitizer sees those faults where they happen.
  target_compile_options(swath_settings INTERFACE -fsanitize=${SWATH_SANITIZE}
    -fno-sanitize=null,alignment,object-size,vptr,pointer-overflow -fno-omit-frame-pointer $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  # With the address sanitizer Eigen's headers free by another way than PCL's library, built without it, allocates. Both are 16-byte aligned.
  target_compile_definitions(swath_settings INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  target_link_options(swath_settings INTERFACE -fsanitize=${SWATH_SANITIZE})
endif()

# Counts the lines that run, of the rooms' own code alone: what the libraries' templates make is not counted and costs nothing (scripts/coverage.sh).
add_library(swath_coverage INTERFACE)
# ccache compiles nothing whose options it does not know: where it is in use, coverage_compiler.sh gives GCC the files to leave out.
if(SWATH_COVERAGE)
  target_compile_options(swath_coverage INTERFACE --coverage)
  target_link_options(swath_coverage INTERFACE --coverage)
  set(coverage_compiler ${PROJECT_SOURCE_DIR}/cmake/coverage_compiler.sh)
  set(coverage_launcher ${coverage_compiler})
  if(CCACHE_PROGRAM)
    set(coverage_launcher ${CMAKE_COMMAND} -E env CCACHE_PREFIX=${coverage_compiler} CCACHE_EXTRAFILES=${coverage_compiler} ${CCACHE_PROGRAM})
  endif()
endif()

# A fault, should one be left, stops the program instead of running on (docs/security.md; tests/cli/hardening_test.py). Some systems' compilers
# define _FORTIFY_SOURCE themselves, and it needs optimization. The sanitizers take the place of these flags.
# Position-independent for programs and shared libraries alike, so that a Python module links the objects of the program.
if(NOT SWATH_SANITIZE)
  target_compile_options(swath_settings INTERFACE -fstack-protector-strong -fstack-clash-protection -fPIC -fno-semantic-interposition -fvisibility=hidden
    $<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=3>)
  target_link_options(swath_settings INTERFACE $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:-pie> -Wl,-z,relro,-z,now,-z,noexecstack)
endif()

function(swath_room room)
  cmake_parse_arguments(R "" "" "UNITS;USES;LIBRARIES;PUBLIC_LIBRARIES;SOURCES" ${ARGN})
  set(sources ${R_SOURCES})
  set(tests "")
  foreach(unit IN LISTS R_UNITS)
    set(test ${PROJECT_SOURCE_DIR}/tests/${room}/${unit}_test.cpp)
    foreach(file ${CMAKE_CURRENT_SOURCE_DIR}/${unit}.h ${CMAKE_CURRENT_SOURCE_DIR}/${unit}.cpp ${test})
      if(NOT EXISTS ${file})
        message(FATAL_ERROR "unit ${room}/${unit} needs ${file}")
      endif()
    endforeach()
    list(APPEND sources ${unit}.cpp)
    list(APPEND tests ${test})
  endforeach()
  add_library(swath_${room} STATIC ${sources})
  add_library(swath::${room} ALIAS swath_${room})
  target_include_directories(swath_${room} PUBLIC ${PROJECT_SOURCE_DIR})
  foreach(used IN LISTS R_USES)
    target_link_libraries(swath_${room} PUBLIC swath::${used})
  endforeach()
  target_link_libraries(swath_${room} PUBLIC ${R_PUBLIC_LIBRARIES} PRIVATE ${R_LIBRARIES}
    $<BUILD_INTERFACE:swath_settings> $<BUILD_INTERFACE:swath_coverage>)
  if(SWATH_COVERAGE)
    set_target_properties(swath_${room} PROPERTIES CXX_COMPILER_LAUNCHER "${coverage_launcher}")
  endif()
  if(SWATH_UNITY)
    swath_unity(swath_${room} ${room} ${sources})
  endif()
  set_property(GLOBAL PROPERTY swath_tests_${room} ${tests})
  set_property(GLOBAL APPEND PROPERTY swath_rooms swath_${room})
endfunction()

# The units of a folder are compiled as one file: their headers are read, and their templates made, once. Names that are local to a unit are
# therefore its folder's. Sources with compile options of their own stay alone.
function(swath_unity target room)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  foreach(source IN LISTS ARGN)
    get_filename_component(folder ${source} DIRECTORY)
    if("${room}/${folder}" IN_LIST SWATH_UNITY_EXCEPT)
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
    string(MAKE_C_IDENTIFIER "${room}/${folder}" group)
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
  endforeach()
endfunction()

# Takes out of the list named `of` the files all of whose suites stand in the GoogleTest filter `slow` as "Suite.*".
function(swath_without_slow of slow)
  string(REPLACE ":" ";" patterns "${slow}")
  set(quick "")
  foreach(file IN LISTS ${of})
    file(STRINGS ${file} suites REGEX "^ *TEST(_F|_P)?\\([A-Za-z0-9]+,")
    set(keep FALSE)
    foreach(suite IN LISTS suites)
      string(REGEX REPLACE "^ *TEST[_FP]*\\(([A-Za-z0-9]+),.*" "\\1.*" suite "${suite}")
      if(NOT suite IN_LIST patterns)
        set(keep TRUE)
      endif()
    endforeach()
    if(keep OR NOT suites)
      list(APPEND quick ${file})
    endif()
  endforeach()
  set(${of} ${quick} PARENT_SCOPE)
endfunction()

# The tests of one room, one executable; further sources and libraries after the name. SLOW: suites that take minutes under sanitizers,
# as a filter of GoogleTest; they get the label `slow`.
function(swath_room_tests room)
  cmake_parse_arguments(T "" "SLOW" "SOURCES;LIBRARIES" ${ARGN})
  get_property(tests GLOBAL PROPERTY swath_tests_${room})
  list(APPEND tests ${T_SOURCES})
  if(T_SLOW AND NOT SWATH_SLOW_TESTS)
    swath_without_slow(tests "${T_SLOW}")
  endif()
  if(NOT tests)
    return()
  endif()
  add_executable(${room}_tests ${tests})
  target_link_libraries(${room}_tests PRIVATE swath::${room} ${T_LIBRARIES} swath_test_support swath_settings GTest::gtest_main)
  # The rooms do the work: the tests themselves compile in three quarters of the time.
  target_compile_options(${room}_tests PRIVATE $<$<CONFIG:Release>:-O1>)
  # Most of that goes into reading what nearly all of them include.
  target_precompile_headers(${room}_tests PRIVATE <gtest/gtest.h> <Eigen/Dense> <algorithm> <cmath> <filesystem> <fstream> <functional> <map>
    <memory> <optional> <random> <set> <sstream> <string> <vector>)
  if(CCACHE_PROGRAM)
    set_target_properties(${room}_tests PROPERTIES CXX_COMPILER_LAUNCHER
      "${CMAKE_COMMAND};-E;env;CCACHE_SLOPPINESS=pch_defines,time_macros;${CCACHE_PROGRAM}")
  endif()
  if(T_SLOW)
    gtest_discover_tests(${room}_tests TEST_FILTER "${T_SLOW}" TEST_LIST ${room}_slow DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 900 LABELS slow)
    gtest_discover_tests(${room}_tests TEST_FILTER "-${T_SLOW}" DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 600)
  else()
    gtest_discover_tests(${room}_tests DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 600)
  endif()
endfunction()
