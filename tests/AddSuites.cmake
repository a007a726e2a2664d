# What ctest reads before it runs tests: the suites of a test program, one entry each, because most
# tests take less time than the start of a process. A failure names its tests in the output.
#   TEST_PROGRAM  the program; SEPARATE  suites that are long: each of their tests is an entry

if(NOT EXISTS "${TEST_PROGRAM}")
  add_test(${TEST_NAME}_NOT_BUILT "${TEST_PROGRAM}")
  return()
endif()
execute_process(COMMAND "${TEST_PROGRAM}" --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE status
  TIMEOUT 60)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${TEST_PROGRAM} does not list its tests: ${status}")
endif()
string(REGEX REPLACE "#[^\n]*" "" listed "${listed}") # values of parameters
string(REGEX MATCHALL "[^\n]+" lines "${listed}")
foreach(line IN LISTS lines)
  if(line MATCHES "^([^ ]+)\\. *$")
    set(suite "${CMAKE_MATCH_1}")
    list(FIND SEPARATE "${suite}" separate)
    if(separate EQUAL -1)
      add_test("${suite}" "${TEST_PROGRAM}" "--gtest_filter=${suite}.*")
    endif()
  elseif(line MATCHES "^  ([^ ]+) *$" AND separate GREATER -1)
    add_test("${suite}.${CMAKE_MATCH_1}" "${TEST_PROGRAM}" "--gtest_filter=${suite}.${CMAKE_MATCH_1}")
    set_tests_properties("${suite}.${CMAKE_MATCH_1}" PROPERTIES COST 5)
  endif()
endforeach()
