# SPDX-License-Identifier: GPL-3.0-or-later
# Our LAS and LAZ files against laspy + lazrs in a virtual environment of the build tree; skipped where pip has no network.
add_executable(las_samples ${CMAKE_CURRENT_LIST_DIR}/las_samples.cpp)
target_link_libraries(las_samples PRIVATE swath::io swath_settings)
find_package(Python3 COMPONENTS Interpreter)
if(Python3_FOUND)
  set(laspy_venv ${PROJECT_BINARY_DIR}/laspy)
  add_test(NAME laspy.environment
    COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/laspy_environment.py ${laspy_venv} ${CMAKE_CURRENT_LIST_DIR}/requirements.txt)
  add_test(NAME laspy.las_files_both_ways
    COMMAND sh -c "if [ -x '${laspy_venv}/bin/python' ]; then exec '${laspy_venv}/bin/python' \"$@\"; else echo 'SKIPPED: no laspy environment'; exit 77; fi"
            laspy ${CMAKE_CURRENT_LIST_DIR}/laspy_check.py $<TARGET_FILE:las_samples> ${PROJECT_BINARY_DIR}/laspy_files)
  add_test(NAME laspy.copc_files_field_by_field
    COMMAND sh -c "if [ -x '${laspy_venv}/bin/python' ]; then exec '${laspy_venv}/bin/python' \"$@\"; else echo 'SKIPPED: no laspy environment'; exit 77; fi"
            laspy ${CMAKE_CURRENT_LIST_DIR}/copc_check.py $<TARGET_FILE:las_samples> ${PROJECT_BINARY_DIR}/copc_files ${CMAKE_CURRENT_LIST_DIR}/copcjs)
  set(stac_venv ${PROJECT_BINARY_DIR}/stac)
  add_test(NAME stac.environment
    COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/laspy_environment.py ${stac_venv} ${CMAKE_CURRENT_LIST_DIR}/stac_requirements.txt)
  add_test(NAME stac.virtual_point_cloud
    COMMAND sh -c "if [ -x '${stac_venv}/bin/python' ]; then exec '${stac_venv}/bin/python' \"$@\"; else echo 'SKIPPED: no pystac environment'; exit 77; fi"
            pystac ${CMAKE_CURRENT_LIST_DIR}/vpc_check.py $<TARGET_FILE:las_samples> ${PROJECT_BINARY_DIR}/vpc_files)
  set_tests_properties(stac.environment PROPERTIES FIXTURES_SETUP stac SKIP_RETURN_CODE 77 TIMEOUT 300)
  set_tests_properties(stac.virtual_point_cloud PROPERTIES FIXTURES_REQUIRED stac SKIP_RETURN_CODE 77 TIMEOUT 300)
  set_tests_properties(laspy.environment PROPERTIES FIXTURES_SETUP laspy SKIP_RETURN_CODE 77 TIMEOUT 300)
  set_tests_properties(laspy.las_files_both_ways laspy.copc_files_field_by_field PROPERTIES FIXTURES_REQUIRED laspy SKIP_RETURN_CODE 77 TIMEOUT 600)
endif()
