# The module `_xray` and the list of the package's other files: of the whole project's build and of the projector alone.
find_package(pybind11 2.10 REQUIRED)
pybind11_add_module(_xray MODULE NO_EXTRAS "${CMAKE_CURRENT_LIST_DIR}/xray.cxx")
set(MAMMORAY_PYTHON_SOURCES)
foreach (name IN ITEMS __init__ _breast _errors _filters _mesh _scene _values torch)
  list(APPEND MAMMORAY_PYTHON_SOURCES "${CMAKE_CURRENT_LIST_DIR}/mammoray/${name}.py")
endforeach ()
foreach (name IN ITEMS _xray.pyi py.typed)
  list(APPEND MAMMORAY_PYTHON_SOURCES "${CMAKE_CURRENT_LIST_DIR}/mammoray/${name}")
endforeach ()
execute_process(COMMAND "${Python3_EXECUTABLE}" -c
  "import numpy, os; print(os.path.dirname(os.path.dirname(numpy.__file__)), end='')"
  OUTPUT_VARIABLE MAMMORAY_PYTHON_PACKAGES COMMAND_ERROR_IS_FATAL ANY)
set(MAMMORAY_PYTHON_VERSION "${PROJECT_VERSION}")
set(MAMMORAY_PYTHON_EXECUTABLE "${Python3_EXECUTABLE}")
configure_file("${CMAKE_CURRENT_LIST_DIR}/mammoray/_build.py.in" "${CMAKE_CURRENT_BINARY_DIR}/mammoray/_build.py" @ONLY)
list(APPEND MAMMORAY_PYTHON_SOURCES "${CMAKE_CURRENT_BINARY_DIR}/mammoray/_build.py")
