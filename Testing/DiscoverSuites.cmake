# Writes a file that tells CTest of a GoogleTest program's suites, one test each: starting a program, and a device in
# it, takes longer than most of their tests.
#
#   cmake -D PROGRAM=<file> -D OUTPUT=<file> -D LABELS=<labels> -D TIMEOUT=<seconds> -P DiscoverSuites.cmake
execute_process(COMMAND "${PROGRAM}" --gtest_list_tests
  OUTPUT_VARIABLE listed RESULT_VARIABLE failure TIMEOUT 60)
if (NOT failure EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests: ${failure}")
endif ()
string(REPLACE "\n" ";" listed "${listed}")
# Skipped is a suite all of whose tests are; what comes after the list of these would be one of failures.
string(CONCAT skipped "\\\\[  PASSED  \\\\] 0 tests\\\\.\n"
  "\\\\[  SKIPPED \\\\] [0-9]+ tests?, listed below:\n(\\\\[  SKIPPED \\\\][^\n]*\n?)+$")
set(script "")
foreach (line IN LISTS listed)
  if (line MATCHES "^([^ ]+)\\.( |$)")
    string(APPEND script "add_test([[${CMAKE_MATCH_1}]] [[${PROGRAM}]] [[--gtest_filter=${CMAKE_MATCH_1}.*]])\n"
      "set_tests_properties([[${CMAKE_MATCH_1}]] PROPERTIES TIMEOUT ${TIMEOUT} LABELS [[${LABELS}]] "
      "SKIP_REGULAR_EXPRESSION \"${skipped}\")\n")
  endif ()
endforeach ()
file(WRITE "${OUTPUT}" "${script}")
