# Settings that all Debian packages share (cpack, generator DEB): the set of the whole project and that of the projector alone.
set(MAMMORAY_PACKAGING "${CMAKE_CURRENT_LIST_DIR}")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR MammoRay)
set(MAMMORAY_MAINTAINER "MammoRay maintainers <maintainers@mammoray.example>" CACHE STRING
  "Name and address of who maintains the packages; there is none yet")
set(CPACK_PACKAGE_CONTACT "${MAMMORAY_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "synthetic X-rays of meshes, registration of breast MRI with mammograms")
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGING_INSTALL_PREFIX "/usr")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(same_version "(= ${PROJECT_VERSION})")
# mammoray_package(<component> <package> <section> <depends> <summary> <description> [<component>...])
# With several components, the first name is that of their group.
macro (mammoray_package component package section depends summary description)
  string(TOUPPER "${component}" upper)
  if (${ARGC} EQUAL 6)
    list(APPEND CPACK_COMPONENTS_ALL ${component})
    set(package_of_${component} "${package}")
  else ()
    foreach (part IN ITEMS ${ARGN})
      list(APPEND CPACK_COMPONENTS_ALL ${part})
      set(package_of_${part} "${package}")
      string(TOUPPER "${part}" part)
      set(CPACK_COMPONENT_${part}_GROUP ${component})
    endforeach ()
  endif ()
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME "${package}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION "${section}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}")
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\n${description}")
endmacro ()
set(CPACK_COMPONENTS_ALL)
set(about "MammoRay meshes a segmented breast MRI, compresses it between the plates of a
mammography unit, X-rays it by Vulkan ray tracing, and fits the compression
until the synthetic mammogram matches a real one.")

set(documents "${CMAKE_BINARY_DIR}/packaging")
find_program(GZIP gzip REQUIRED)
configure_file("${MAMMORAY_PACKAGING}/changelog" "${documents}/changelog" @ONLY)
add_custom_command(OUTPUT "${documents}/changelog.gz"
  COMMAND "${CMAKE_COMMAND}" -D "SOURCE=${documents}/changelog" -D "TARGET=${documents}/changelog.gz"
    -D "GZIP=${GZIP}" -P "${MAMMORAY_PACKAGING}/Compress.cmake"
  DEPENDS "${documents}/changelog" VERBATIM)
set(package_documents "${documents}/changelog.gz")
# Copyright (a file of this folder; of mammoray-data copyright.data) and changelog of every package; to be called when all
# components are known.
macro (mammoray_package_documents copyright)
  foreach (component IN LISTS CPACK_COMPONENTS_ALL)
    set(file "${copyright}")
    if ("${package_of_${component}}" STREQUAL mammoray-data)
      set(file copyright.data)
    endif ()
    install(FILES "${MAMMORAY_PACKAGING}/${file}" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package_of_${component}}"
      RENAME copyright COMPONENT ${component})
    install(FILES "${documents}/changelog.gz" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package_of_${component}}"
      COMPONENT ${component} OPTIONAL)
  endforeach ()
endmacro ()
