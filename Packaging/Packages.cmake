# What goes into which Debian package (cpack, generator DEB), with the manual pages, the completion script, copyright
# and changelog that Debian's policy asks for. The components are those of the install rules.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR MammoRay)
set(CPACK_PACKAGE_CONTACT "MammoRay maintainers <maintainers@mammoray.example>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "synthetic X-rays of meshes, registration of breast MRI with mammograms")
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGING_INSTALL_PREFIX "/usr")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_HOMEPAGE "https://mammoray.example")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR}")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(soversion "${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}")
set(libraries "libmammoray${soversion}")
set(same_version "(= ${PROJECT_VERSION})")

# mammoray_package(<component> <package> <section> <depends> <summary> <description>)
macro (mammoray_package component package section depends summary description)
  string(TOUPPER "${component}" upper)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(package_of_${component} "${package}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME "${package}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION "${section}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}")
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\n${description}")
endmacro ()
set(CPACK_COMPONENTS_ALL)
set(about "MammoRay meshes a segmented breast MRI, compresses it between the plates of a
mammography unit, X-rays it by Vulkan ray tracing, and fits the compression
until the synthetic mammogram matches a real one.")
mammoray_package(data mammoray-data science ""
  "attenuation tables, spectra and a phantom for MammoRay"
  "${about}\n\nThis package has the tables that its X-rays need, and a phantom breast with its\nmammogram.")
mammoray_package(runtime ${libraries} libs "mammoray-data ${same_version}, libvulkan1"
  "X-ray projection and breast registration, libraries"
  "${about}\n\nThis package has the shared libraries.")
if (MAMMORAY_BUILD_APPLICATIONS)
  mammoray_package(program mammoray science "${libraries} ${same_version}"
    "registration of breast MRI with mammograms by synthetic X-rays"
    "${about}\n\nThis package has the program; 'mammoray demo' shows what it does.")
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "mesa-vulkan-drivers (>= 24.1) | vulkan-icd")
endif ()
set(development_depends "${libraries} ${same_version}, libvtk9-dev")
if (MAMMORAY_WRAP_PYTHON)
  # The CMake files name its module, too, and CMake wants to see it.
  string(APPEND development_depends ", python3-mammoray ${same_version}")
  mammoray_package(python python3-mammoray python "${libraries} ${same_version}, python3, python3-numpy, python3-vtk9"
    "X-ray projection and breast registration for Python"
    "${about}\n\nThis package has the Python 3 module: functions of arrays, and VTK filters.")
endif ()
mammoray_package(development libmammoray-dev libdevel
  "${development_depends}"
  "X-ray projection and breast registration, for C++ programs"
  "${about}\n\nThis package has headers and CMake files.")
if (TARGET mammoray_project)
  # Octave's own libraries lie in a folder of theirs, where the octave that loads us has found them.
  cmake_path(GET MAMMORAY_OCTINTERP PARENT_PATH octave_libraries)
  list(APPEND CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${octave_libraries}")
  mammoray_package(octave octave-mammoray math "${libraries} ${same_version}, octave"
    "X-ray projection of meshes for Octave"
    "${about}\n\nThis package has the X-ray projector for Octave.")
endif ()
# Data and headers have no programs in them whose libraries could be asked for.
set(CPACK_DEBIAN_DATA_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DATA_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
# What programs of others that link these libraries are to depend on.
set(shlibs "")
foreach (module IN LISTS MAMMORAY_MODULES)
  string(APPEND shlibs "libmammoray${module} ${soversion} ${libraries} (>= ${PROJECT_VERSION})\n")
endforeach ()
file(WRITE "${CMAKE_BINARY_DIR}/packaging/shlibs" "${shlibs}")
file(WRITE "${CMAKE_BINARY_DIR}/packaging/triggers" "activate-noawait ldconfig\n")
set(control_files "${CMAKE_BINARY_DIR}/packaging/shlibs" "${CMAKE_BINARY_DIR}/packaging/triggers")
file(CHMOD ${control_files} PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA "${control_files}")
configure_file(Packaging/overrides.in "${CMAKE_BINARY_DIR}/packaging/overrides" @ONLY)
install(FILES "${CMAKE_BINARY_DIR}/packaging/overrides" DESTINATION "${CMAKE_INSTALL_DATADIR}/lintian/overrides"
  RENAME ${libraries} COMPONENT runtime)

set(documents "${CMAKE_BINARY_DIR}/packaging")
find_program(GZIP gzip REQUIRED)
add_custom_command(OUTPUT "${documents}/changelog.gz"
  COMMAND "${CMAKE_COMMAND}" -D "SOURCE=${CMAKE_CURRENT_SOURCE_DIR}/Packaging/changelog" -D "TARGET=${documents}/changelog.gz"
    -D "GZIP=${GZIP}" -P "${CMAKE_CURRENT_SOURCE_DIR}/Packaging/Compress.cmake"
  DEPENDS Packaging/changelog VERBATIM)
set(package_documents "${documents}/changelog.gz")
if (TARGET mammoray)
  # A page for the program and for each of its commands; the program itself says which they are.
  add_custom_command(OUTPUT "${documents}/manual.stamp"
    COMMAND "${CMAKE_COMMAND}" -D "PROGRAM=$<TARGET_FILE:mammoray>" -D "FOLDER=${documents}/man1"
      -D "COMPLETION=${documents}/completion" -D "GZIP=${GZIP}" -P "${CMAKE_CURRENT_SOURCE_DIR}/Packaging/Manual.cmake"
    COMMAND "${CMAKE_COMMAND}" -E touch "${documents}/manual.stamp"
    DEPENDS mammoray Packaging/Manual.cmake VERBATIM)
  list(APPEND package_documents "${documents}/manual.stamp")
  install(DIRECTORY "${documents}/man1" DESTINATION "${CMAKE_INSTALL_MANDIR}" COMPONENT program OPTIONAL)
  install(FILES "${documents}/completion" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions"
    RENAME mammoray COMPONENT program OPTIONAL)
endif ()
add_custom_target(packageDocuments DEPENDS ${package_documents})
foreach (component IN LISTS CPACK_COMPONENTS_ALL)
  install(FILES Packaging/copyright DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package_of_${component}}"
    COMPONENT ${component})
  install(FILES "${documents}/changelog.gz" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package_of_${component}}"
    COMPONENT ${component} OPTIONAL)
endforeach ()
include(CPack)
