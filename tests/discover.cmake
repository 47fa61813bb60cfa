# What doctest_discover_tests of doctest.cmake does, in two or three processes a program: that one starts one for every case to learn its
# label, 1 100 in all. Included, this file defines
#     knap_discover_tests(TARGET PREFIX)
# and run with cmake -P after each build of TARGET, it writes the tests of TARGET, PREFIX before their names, for ctest. A test
# suite is a label: TEST_CASE("..." * doctest::test_suite("slow")).
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(KNAP_DISCOVER ${CMAKE_CURRENT_LIST_FILE})
  function(knap_discover_tests target prefix)
    set(tests ${CMAKE_CURRENT_BINARY_DIR}/${target}_tests.cmake)
    add_custom_command(TARGET ${target} POST_BUILD BYPRODUCTS ${tests} VERBATIM
      COMMAND ${CMAKE_COMMAND} -D PROGRAM=$<TARGET_FILE:${target}> -D PREFIX=${prefix} -D TESTS=${tests} -P ${KNAP_DISCOVER})
    set(included ${CMAKE_CURRENT_BINARY_DIR}/${target}_include.cmake)
    file(WRITE ${included} "if(EXISTS \"${tests}\")\n  include(\"${tests}\")\nelse()\n  add_test(${target}_NOT_BUILT ${target}_NOT_BUILT)\nendif()\n")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${included})
  endfunction()
  return()
endif()

cmake_minimum_required(VERSION 3.25)  # its policies

# What the program lists with these options, a line each; a program without cases lists none and fails.
function(list_with result)
  execute_process(COMMAND ${PROGRAM} --no-intro ${ARGN} OUTPUT_VARIABLE output RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "${PROGRAM} ${ARGN}: ${failed}\n${output}")
  endif()
  string(REPLACE "\n" ";" lines "${output}")
  list(FILTER lines EXCLUDE REGEX "^(\\[doctest\\] .*|=+)?$")
  set(${result} "${lines}" PARENT_SCOPE)
endfunction()

list_with(cases --list-test-cases)
list_with(suites --list-test-suites)
foreach(suite ${suites})
  list_with(cases_of_${suite} --list-test-cases --test-suite=${suite})
endforeach()

cmake_path(GET PROGRAM PARENT_PATH folder)
set(script "")
foreach(case IN LISTS cases)
  set(labels "")
  foreach(suite ${suites})
    if(case IN_LIST cases_of_${suite})
      list(APPEND labels ${suite})
    endif()
  endforeach()
  set(name "[==[${PREFIX}${case}]==]")
  string(APPEND script "add_test(${name} [==[${PROGRAM}]==] [==[--test-case=${case}]==])\n"
    "set_tests_properties(${name} PROPERTIES WORKING_DIRECTORY [==[${folder}]==] TIMEOUT 600 ENVIRONMENT OMP_WAIT_POLICY=passive LABELS \"${labels}\")\n")
endforeach()
file(WRITE ${TESTS} "${script}")
