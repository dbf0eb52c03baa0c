# cmake -DFOUND=VERSION -P findTried.cmake: a package of this version, of which 9.1 to 9.3 were tried.
include("${CMAKE_CURRENT_LIST_DIR}/../../Modules/MammoRayModule.cmake")
set(Tried_DIR "${CMAKE_CURRENT_BINARY_DIR}/tried-${FOUND}")
file(WRITE "${Tried_DIR}/TriedConfig.cmake" "")
# Like those of ITK and CGAL, it does not look at an upper end.
file(WRITE "${Tried_DIR}/TriedConfigVersion.cmake" "set(PACKAGE_VERSION ${FOUND})
if (NOT PACKAGE_VERSION VERSION_LESS PACKAGE_FIND_VERSION)
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
endif ()")
mammoray_find_tried(Tried 9.1 9.3 REQUIRED)
message(STATUS "took ${Tried_VERSION}")
