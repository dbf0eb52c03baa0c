# Contents of the Debian packages (cpack, generator DEB), with the manual pages, the completion script, copyright
# and changelog that Debian's policy asks for. The components are those of the install rules.
include("${CMAKE_CURRENT_SOURCE_DIR}/Packaging/Settings.cmake")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR}")

set(soversion "${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}")

# All that a registration needs, so that one file can be installed alone.
mammoray_package(suite mammoray science libvulkan1
  "registration of breast MRI with mammograms by synthetic X-rays"
  "${about}\n\nThis package has the program, its libraries, tables and a phantom breast;\n'mammoray demo' shows what it does."
  runtime program data)
set(CPACK_DEBIAN_SUITE_PACKAGE_RECOMMENDS "mesa-vulkan-drivers (>= 24.1) | vulkan-icd")
set(CPACK_DEBIAN_SUITE_PACKAGE_PROVIDES "mammoray-data ${same_version}")
set(CPACK_DEBIAN_SUITE_PACKAGE_CONFLICTS mammoray-data)
set(CPACK_DEBIAN_SUITE_PACKAGE_REPLACES mammoray-data)
set(development_depends "mammoray ${same_version}, libvtk9-dev")
if (MAMMORAY_WRAP_PYTHON)
  # The CMake files name its module, too, and CMake wants to see it.
  string(APPEND development_depends ", python3-mammoray ${same_version}")
  mammoray_package(python python3-mammoray python "mammoray ${same_version}, python3, python3-numpy, python3-vtk9"
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
  mammoray_package(octave octave-mammoray math "mammoray ${same_version}, octave"
    "X-ray projection of meshes for Octave"
    "${about}\n\nThis package has the X-ray projector for Octave.")
endif ()
if (TARGET mammoray-app)
  mammoray_package(desktop mammoray-app science "mammoray ${same_version}, hicolor-icon-theme"
    "desktop application for breast MRI, mammograms and X-ray scenes"
    "${about}\n\nThis package has the desktop application, which 'mammoray app' starts.")
  # The command of its menu entry is in the package mammoray, on which it depends.
  file(WRITE "${CMAKE_BINARY_DIR}/packaging/mammoray-app" "mammoray-app: desktop-command-not-in-package mammoray *\n")
  install(FILES "${CMAKE_BINARY_DIR}/packaging/mammoray-app" DESTINATION "${CMAKE_INSTALL_DATADIR}/lintian/overrides"
    COMPONENT desktop)
endif ()
# Headers have no programs in them whose libraries could be asked for.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
# Dependencies of other programs that link these libraries.
set(shlibs "")
foreach (module IN LISTS MAMMORAY_MODULES)
  string(APPEND shlibs "libmammoray${module} ${soversion} mammoray (>= ${PROJECT_VERSION})\n")
endforeach ()
file(WRITE "${CMAKE_BINARY_DIR}/packaging/shlibs" "${shlibs}")
file(WRITE "${CMAKE_BINARY_DIR}/packaging/triggers" "activate-noawait ldconfig\n")
set(control_files "${CMAKE_BINARY_DIR}/packaging/shlibs" "${CMAKE_BINARY_DIR}/packaging/triggers")
file(CHMOD ${control_files} PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
set(CPACK_DEBIAN_SUITE_PACKAGE_CONTROL_EXTRA "${control_files}")
install(FILES Packaging/overrides DESTINATION "${CMAKE_INSTALL_DATADIR}/lintian/overrides"
  RENAME mammoray COMPONENT runtime)

if (TARGET mammoray)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  # A page for the program and for each of its commands; the program itself says which they are.
  add_custom_command(OUTPUT "${documents}/manual.stamp"
    COMMAND "${CMAKE_COMMAND}" -E rm -rf "${documents}/man1"
    COMMAND "${Python3_EXECUTABLE}" "${CMAKE_CURRENT_SOURCE_DIR}/Applications/mammoray/writeReference.py"
      "$<TARGET_FILE:mammoray>" "${documents}"
    COMMAND "${CMAKE_COMMAND}" -E touch "${documents}/manual.stamp"
    DEPENDS mammoray Applications/mammoray/writeReference.py VERBATIM)
  list(APPEND package_documents "${documents}/manual.stamp")
  install(DIRECTORY "${documents}/man1" DESTINATION "${CMAKE_INSTALL_MANDIR}" COMPONENT program OPTIONAL)
  install(FILES "${documents}/completion" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions"
    RENAME mammoray COMPONENT program OPTIONAL)
endif ()
add_custom_target(packageDocuments DEPENDS ${package_documents})
mammoray_package_documents(copyright)
include(CPack)
