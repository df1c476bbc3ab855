# SPDX-License-Identifier: GPL-3.0-or-later
# What is installed, and the Debian package (scripts/package_deb.sh). The pages that the program makes of itself are made with it.
set(pages ${PROJECT_BINARY_DIR}/pages)
add_custom_command(OUTPUT ${pages}/swath.1.gz
  COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:swath> -DPAGES=${pages} -P ${PROJECT_SOURCE_DIR}/cmake/pages.cmake
  DEPENDS swath ${PROJECT_SOURCE_DIR}/cmake/pages.cmake VERBATIM)
add_custom_target(swath_manual ALL DEPENDS ${pages}/swath.1.gz)

install(FILES ${pages}/swath.1.gz DESTINATION share/man/man1)
install(FILES ${pages}/swath.bash DESTINATION share/bash-completion/completions RENAME swath)
install(FILES ${pages}/swath.zsh DESTINATION share/zsh/vendor-completions RENAME _swath)
install(FILES ${pages}/swath.fish DESTINATION share/fish/vendor_completions.d)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/cmake/copyright DESTINATION share/doc/swath)

# GDAL is not among the libraries that the program is linked with, by which the package's dependencies are found.
set(delayed_package "")
find_program(DPKG_QUERY dpkg-query)
if(SWATH_DELAY_GDAL AND DPKG_QUERY)
  get_target_property(gdal_file GDAL::GDAL IMPORTED_LOCATION)
  if(NOT gdal_file)
    get_target_property(gdal_file GDAL::GDAL IMPORTED_LOCATION_NONE)
  endif()
  file(REAL_PATH "${gdal_file}" gdal_file)
  execute_process(COMMAND ${DPKG_QUERY} -S ${gdal_file} OUTPUT_VARIABLE owner ERROR_QUIET)
  if(owner MATCHES "^([^:]+):")
    set(delayed_package "${CMAKE_MATCH_1}, ")
  endif()
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME swath)
set(CPACK_PACKAGE_VENDOR "swath")
set(CPACK_PACKAGE_CONTACT "swath developers <swath@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "airborne laser surveys: raw records to terrain models")
set(CPACK_PACKAGE_DESCRIPTION "Takes the raw records of an airborne laser survey (ranges, scan angles, IMU, GNSS)
to georeferenced, classified point clouds, terrain models and contours, and says
how good each of them is.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "${delayed_package}proj-data, fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS rtklib)
include(CPack)
