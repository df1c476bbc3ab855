# SPDX-License-Identifier: GPL-3.0-or-later
# Third parties, found once. Include paths are SYSTEM, so that their headers pass our warnings.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(PROJ REQUIRED CONFIG)
find_package(GDAL REQUIRED)
find_package(CGAL REQUIRED)
set(PCL_FIND_QUIETLY ON)
find_package(PCL REQUIRED COMPONENTS common kdtree search sample_consensus)
# Not as a component: PCL's finder then asks for VTK and that for MPI, which nothing here uses.
find_library(SWATH_PCL_SEGMENTATION pcl_segmentation REQUIRED)
find_package(tomlplusplus REQUIRED CONFIG)
find_package(CLI11 REQUIRED CONFIG)
find_package(PNG REQUIRED)
if(SWATH_TESTS)
  find_package(GTest REQUIRED)
  include(GoogleTest)
endif()
