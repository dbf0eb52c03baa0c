# One GoogleTest executable per module, its tests discovered and labelled.
#
#   mammoray_add_test(<name> SOURCES ... LIBRARIES ... [LABELS ...] [TIMEOUT seconds] [BY_SUITE])
#
# BY_SUITE makes one test of each suite, in one process, where many are quick and none disturbs another; else each is
# a process of its own.
# The folders' names are given to one source only: on every command line they would make each checkout compile all
# tests anew where a compiler cache serves.
set(MAMMORAY_SHARED_DATA_DIR "${PROJECT_SOURCE_DIR}/../shared/data" CACHE PATH
  "Folder with real inputs that are not part of the project; tests that need it skip when it is absent")
set(MAMMORAY_TIMEOUT_FACTOR 1 CACHE STRING "How much longer a test may take than in a release build: a whole number")
find_program(MAMMORAY_XVFB Xvfb DOC "X server without a screen, for the tests of windows")
add_library(mammorayTestSupport STATIC "${CMAKE_CURRENT_LIST_DIR}/Support/Places.cxx")
mammoray_configure_target(mammorayTestSupport)
target_link_libraries(mammorayTestSupport PRIVATE GTest::gmock GTest::gtest)
# Read once for all tests. They are executables, and a precompiled header wants the same code model.
target_precompile_headers(mammorayTestSupport PRIVATE
  <algorithm> <array> <cmath> <filesystem> <fstream> <functional> <numbers> <random> <sstream> <string> <vector>
  <gmock/gmock.h> <gtest/gtest.h>)
set_target_properties(mammorayTestSupport PROPERTIES POSITION_INDEPENDENT_CODE OFF)
# The modules are compiled as they are shipped; the tests themselves, four of ten lines, in two thirds of the time.
set(MAMMORAY_TEST_OPTIONS "$<$<CONFIG:Release>:-O1>")
target_compile_options(mammorayTestSupport PRIVATE -fPIE ${MAMMORAY_TEST_OPTIONS})
# For the one source: a precompiled header wants the same definitions, too.
set_source_files_properties("${CMAKE_CURRENT_LIST_DIR}/Support/Places.cxx" PROPERTIES COMPILE_DEFINITIONS
  "MAMMORAY_DATA_DIR=\"${PROJECT_SOURCE_DIR}/Data\";MAMMORAY_SHARED_DATA_DIR=\"${MAMMORAY_SHARED_DATA_DIR}\";MAMMORAY_EXECUTABLE=\"$<$<TARGET_EXISTS:mammoray>:$<TARGET_FILE:mammoray>>\";MAMMORAY_XVFB=\"$<$<BOOL:${MAMMORAY_XVFB}>:${MAMMORAY_XVFB}>\"")
function (mammoray_add_test name)
  cmake_parse_arguments(PARSE_ARGV 1 test "BY_SUITE" "TIMEOUT" "SOURCES;LIBRARIES;LABELS")
  if (NOT test_TIMEOUT AND test_BY_SUITE)
    set(test_TIMEOUT 900)
  elseif (NOT test_TIMEOUT)
    set(test_TIMEOUT 300)
  endif ()
  math(EXPR test_TIMEOUT "${test_TIMEOUT} * ${MAMMORAY_TIMEOUT_FACTOR}")
  add_executable(${name} ${test_SOURCES})
  mammoray_configure_target(${name})
  target_compile_options(${name} PRIVATE ${MAMMORAY_TEST_OPTIONS})
  target_precompile_headers(${name} REUSE_FROM mammorayTestSupport)
  # Where sources are read several at once: most of a test's time goes into templates that all of them make.
  set_target_properties(${name} PROPERTIES UNITY_BUILD_BATCH_SIZE 16)
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}/Testing/Support")
  target_link_libraries(${name} PRIVATE ${test_LIBRARIES} mammorayTestSupport GTest::gmock GTest::gtest_main)
  if (test_BY_SUITE)
    set(discovered "${CMAKE_CURRENT_BINARY_DIR}/${name}Suites.cmake")
    set(script "${PROJECT_SOURCE_DIR}/Testing/DiscoverSuites.cmake")
    add_custom_command(TARGET ${name} POST_BUILD
      COMMAND "${CMAKE_COMMAND}" -D "PROGRAM=$<TARGET_FILE:${name}>" -D "OUTPUT=${discovered}"
              -D "LABELS=${test_LABELS}" -D TIMEOUT=${test_TIMEOUT} -P "${script}"
      VERBATIM)
    set_property(TARGET ${name} PROPERTY LINK_DEPENDS "${script}")
    file(WRITE "${CMAKE_CURRENT_BINARY_DIR}/${name}Tests.cmake"
      "if (EXISTS [[${discovered}]])\n  include([[${discovered}]])\nelse ()\n"
      "  add_test(${name}_NOT_BUILT ${name}_NOT_BUILT)\nendif ()\n")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${CMAKE_CURRENT_BINARY_DIR}/${name}Tests.cmake")
  else ()
    gtest_discover_tests(${name}
      DISCOVERY_TIMEOUT 60
      PROPERTIES TIMEOUT ${test_TIMEOUT} LABELS "${test_LABELS}")
  endif ()
endfunction ()
