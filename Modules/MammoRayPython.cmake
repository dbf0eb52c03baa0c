# The Python package `mammoray`: the wrapped modules beside VTK's own vtkmodules.
set(package_destination "lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/site-packages")
set(CMAKE_INSTALL_RPATH "$ORIGIN/../../..")
vtk_module_wrap_python(
  MODULES ${modules}
  PYTHON_PACKAGE mammoray
  MODULE_DESTINATION "${package_destination}"
  CMAKE_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/mammoray"
  WRAPPED_MODULES wrapped_modules
  TARGET MammoRay::Python
  INSTALL_EXPORT MammoRay)
configure_file(python/__init__.py "${CMAKE_BINARY_DIR}/${package_destination}/mammoray/__init__.py" COPYONLY)
install(FILES python/__init__.py DESTINATION "${package_destination}/mammoray")
