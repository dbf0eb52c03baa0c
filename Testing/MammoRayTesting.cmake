# One GoogleTest executable per module, its tests discovered and labelled.
#
#   mammoray_add_test(<name> SOURCES ... LIBRARIES ... [LABELS ...] [TIMEOUT seconds])
#
# MAMMORAY_DATA_DIR is the project's Data folder; MAMMORAY_SHARED_DATA_DIR the folder of real inputs that may be absent
# (tests skip then).
set(MAMMORAY_SHARED_DATA_DIR "${PROJECT_SOURCE_DIR}/../shared/data" CACHE PATH
  "Folder with real inputs that are not part of the project; tests that need it skip when it is absent")
function (mammoray_add_test name)
  cmake_parse_arguments(PARSE_ARGV 1 test "" "TIMEOUT" "SOURCES;LIBRARIES;LABELS")
  if (NOT test_TIMEOUT)
    set(test_TIMEOUT 300)
  endif ()
  add_executable(${name} ${test_SOURCES})
  mammoray_configure_target(${name})
  target_compile_definitions(${name} PRIVATE
    MAMMORAY_DATA_DIR="${PROJECT_SOURCE_DIR}/Data"
    MAMMORAY_SHARED_DATA_DIR="${MAMMORAY_SHARED_DATA_DIR}")
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}/Testing/Support")
  target_link_libraries(${name} PRIVATE ${test_LIBRARIES} GTest::gmock GTest::gtest_main)
  gtest_discover_tests(${name}
    DISCOVERY_TIMEOUT 60
    PROPERTIES TIMEOUT ${test_TIMEOUT} LABELS "${test_LABELS}")
endfunction ()
