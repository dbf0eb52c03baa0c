# What every MammoRay module needs: include path, warnings and language level, set on our targets only; and what the
# modules need of VTK.
#
#   mammoray_find_tried(<package> <oldest> <newest> <argument of find_package>...)
#   mammoray_configure_module(<target>)
#   mammoray_vtk_components(<out-variable> <module>...)
#
# Included from the top file and by the ParaView plugin: files under Modules/ run with VTK's older CMake policies.
cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH MAMMORAY_ROOT_DIR)
set(MAMMORAY_WARNING_FLAGS -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
  # Designated initialisers leave members at their stated defaults on purpose.
  -Wno-missing-field-initializers)
if (CMAKE_UNITY_BUILD)
  # There, no source is the main file, to whose anonymous namespace types may refer.
  list(APPEND MAMMORAY_WARNING_FLAGS -Wno-subobject-linkage)
endif ()
if (MAMMORAY_WARNINGS_AS_ERRORS)
  list(APPEND MAMMORAY_WARNING_FLAGS -Werror)
  if (CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    # GCC 14 finds these in its own vectors, where it has inlined them into CGAL's functions.
    list(APPEND MAMMORAY_WARNING_FLAGS -Wno-error=array-bounds -Wno-error=stringop-overflow)
  endif ()
endif ()

# Versions from the oldest to the newest one were tried. Older ones are refused, newer ones are used with a warning: an
# upper end given to find_package is ignored by ITK, CGAL, GDCM and Vulkan.
macro (mammoray_find_tried package oldest newest)
  find_package(${package} ${oldest} ${ARGN})
  # As many numbers as `newest` has: 9.3 includes 9.3.1.
  string(REGEX REPLACE "[0-9]+" "[0-9]+" mammoray_pattern "${newest}")
  string(REGEX MATCH "^${mammoray_pattern}" mammoray_found "${${package}_VERSION}")
  if (${package}_FOUND AND mammoray_found VERSION_GREATER "${newest}")
    message(WARNING "${package}: expected ${oldest} to ${newest}, which were tried, found ${${package}_VERSION}")
  endif ()
endmacro ()

# Headers are included as <mammoray/Module/Name.h>, from the build tree as from an installed copy.
set(MAMMORAY_INCLUDE_DIR "${CMAKE_BINARY_DIR}/include")
file(MAKE_DIRECTORY "${MAMMORAY_INCLUDE_DIR}")
file(CREATE_LINK "${MAMMORAY_ROOT_DIR}/Modules" "${MAMMORAY_INCLUDE_DIR}/mammoray" SYMBOLIC)

# For executables and tests.
function (mammoray_configure_target target)
  target_compile_features(${target} PRIVATE cxx_std_20)
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:${MAMMORAY_WARNING_FLAGS}>)
endfunction ()

function (mammoray_configure_module module)
  vtk_module_include(${module} PUBLIC "$<BUILD_INTERFACE:${MAMMORAY_INCLUDE_DIR}>")
  vtk_module_compile_features(${module} PUBLIC cxx_std_20)
  vtk_module_compile_options(${module} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:${MAMMORAY_WARNING_FLAGS}>)
endfunction ()

# The VTK components that the vtk.module files of these modules name, privately too: VTK only finds what it is asked for.
function (mammoray_vtk_components out)
  set(components)
  foreach (module IN LISTS ARGN)
    set(file "${MAMMORAY_ROOT_DIR}/Modules/${module}/vtk.module")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
    file(STRINGS "${file}" lines REGEX "^ *VTK::")
    list(TRANSFORM lines REPLACE "^ *VTK::" "")
    list(APPEND components ${lines})
  endforeach ()
  list(REMOVE_DUPLICATES components)
  list(SORT components)
  set(${out} ${components} PARENT_SCOPE)
endfunction ()
