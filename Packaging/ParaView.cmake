# The plugin for Debian's ParaView, of the first set: it has all modules that the filters need, built against ParaView's VTK.
include("${CMAKE_CURRENT_LIST_DIR}/Settings.cmake")
mammoray_package(paraview paraview-mammoray science
  "mammoray-data ${same_version}, libvulkan1, paraview (>= 5.11), paraview (<< 5.12)"
  "X-ray projection and breast registration in ParaView"
  "${about}\n\nThis package has the filters as a plugin for ParaView;\n'paraview-mammoray' starts ParaView with it.")
set(CPACK_DEBIAN_PARAVIEW_PACKAGE_RECOMMENDS "mesa-vulkan-drivers (>= 24.1) | vulkan-icd")
cmake_path(GET ParaView_DIR PARENT_PATH paraview_libraries) # of .../lib/<triplet>/cmake/paraview-5.11
cmake_path(GET paraview_libraries PARENT_PATH paraview_libraries)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/MammoRay" "${paraview_libraries}")

# Beside ParaView's own.
set(plugin_folder "lib/${CMAKE_LIBRARY_ARCHITECTURE}/paraview-5.11/plugins/MammoRay")
install(TARGETS MammoRay ${MAMMORAY_MODULES} LIBRARY DESTINATION "${plugin_folder}" COMPONENT paraview NAMELINK_SKIP)
configure_file("${MAMMORAY_PACKAGING}/paraview-mammoray.in" "${documents}/paraview-mammoray" @ONLY)
install(PROGRAMS "${documents}/paraview-mammoray" DESTINATION bin COMPONENT paraview)
add_custom_command(OUTPUT "${documents}/paraview-mammoray.1.gz"
  COMMAND "${CMAKE_COMMAND}" -D "SOURCE=${MAMMORAY_PACKAGING}/paraview-mammoray.1" -D "TARGET=${documents}/paraview-mammoray.1.gz"
    -D "GZIP=${GZIP}" -P "${MAMMORAY_PACKAGING}/Compress.cmake"
  DEPENDS "${MAMMORAY_PACKAGING}/paraview-mammoray.1" VERBATIM)
list(APPEND package_documents "${documents}/paraview-mammoray.1.gz")
install(FILES "${documents}/paraview-mammoray.1.gz" DESTINATION share/man/man1 COMPONENT paraview)
# build.sh has ParaView write the state.
install(FILES "${CMAKE_CURRENT_SOURCE_DIR}/openResult.py" "${CMAKE_BINARY_DIR}/packaged/demo.pvsm"
  DESTINATION share/mammoray/paraview COMPONENT paraview)
add_custom_target(packageDocuments ALL DEPENDS ${package_documents})
mammoray_package_documents(copyright)
include(CPack)
