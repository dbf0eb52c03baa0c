# The wrapped modules of the Python package `mammoray`, whose other parts are Wrapping/Python.
set(MAMMORAY_PYTHON_DESTINATION
  "lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/site-packages" CACHE STRING
  "Folder of the Python package below the prefix")
set(package_destination "${MAMMORAY_PYTHON_DESTINATION}")
cmake_path(SET library_folder NORMALIZE "/prefix/${CMAKE_INSTALL_LIBDIR}")
cmake_path(RELATIVE_PATH library_folder BASE_DIRECTORY "/prefix/${package_destination}/mammoray"
  OUTPUT_VARIABLE from_package_to_libraries)
set(CMAKE_INSTALL_RPATH "$ORIGIN/${from_package_to_libraries}")
vtk_module_wrap_python(
  MODULES ${modules}
  PYTHON_PACKAGE mammoray
  MODULE_DESTINATION "${package_destination}"
  CMAKE_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/mammoray"
  WRAPPED_MODULES wrapped_modules
  TARGET MammoRay::Python
  INSTALL_EXPORT MammoRay)
set(MAMMORAY_PYTHON_RPATH "${CMAKE_INSTALL_RPATH}" PARENT_SCOPE)
