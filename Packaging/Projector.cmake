# The second set: the projector alone, without what is under the GPL or the AGPL (copyright.projector says why it is that
# little), and its tables.
include("${CMAKE_CURRENT_LIST_DIR}/Settings.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/Data.cmake")
mammoray_package(data mammoray-data science ""
  "attenuation tables, spectra and a phantom for MammoRay"
  "${about}\n\nThis package has the tables that its X-rays need, and a phantom breast with its\nmammogram. The package mammoray has them, too.")
set(CPACK_DEBIAN_DATA_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DATA_PACKAGE_ARCHITECTURE all)
mammoray_package(projector python3-mammoray-xray python
  "mammoray-data ${same_version}, libvulkan1, python3, python3-numpy"
  "X-ray projection of meshes for Python, without GPL parts"
  "MammoRay X-rays meshes of several materials by Vulkan: path lengths, the\nBeer-Lambert law and exact derivatives, arrays in and out.\n\nThis package has the projector alone; python3-mammoray has the filters for\nmeshing, compression and registration, too.")
set(CPACK_DEBIAN_PROJECTOR_PACKAGE_CONFLICTS python3-mammoray)
set(CPACK_DEBIAN_PROJECTOR_PACKAGE_RECOMMENDS "mesa-vulkan-drivers | vulkan-icd")
add_custom_target(packageDocuments ALL DEPENDS ${package_documents})
mammoray_package_documents(copyright.projector)
include(CPack)
