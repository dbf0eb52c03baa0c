# Tables, spectra and phantoms, the component `data`: in the package mammoray, and on its own for packages that do without the
# libraries.
cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH data)
string(APPEND data "/Data")
install(DIRECTORY "${data}/attenuation" "${data}/materials" "${data}/parts" "${data}/scatter" "${data}/scattered-1001-mlo" "${data}/spectra"
    "${data}/victre-phantom-1"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/mammoray" COMPONENT data PATTERN "*.py" EXCLUDE)
install(FILES "${data}/case.schema.json" "${data}/result.schema.json" DESTINATION "${CMAKE_INSTALL_DATADIR}/mammoray" COMPONENT data)
