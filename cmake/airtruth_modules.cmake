# add_module(NAME SOURCES a.cpp ... [DEPENDS module ...] [LIBRARIES target ...] [PRIVATE_LIBRARIES target ...]
#            [TESTS a_test.cpp ...] [TEST_DEPENDS target ...] [SLOW_TESTS b_test.cpp ...])
# makes the static library airtruth_NAME and, from TESTS, the program NAME_test (one ctest entry; SLOW_TESTS
# make NAME_slow_test, labelled slow; not with sanitizers, under which they take hours).
function(add_module name)
  cmake_parse_arguments(arg "" ""
    "SOURCES;DEPENDS;LIBRARIES;PRIVATE_LIBRARIES;TESTS;TEST_DEPENDS;SLOW_TESTS" ${ARGN})
  if(arg_SOURCES)
    add_library(airtruth_${name} STATIC ${arg_SOURCES})
    set(scope PUBLIC)
  else()
    add_library(airtruth_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  list(TRANSFORM arg_DEPENDS PREPEND airtruth_)
  target_include_directories(airtruth_${name} ${scope} ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(airtruth_${name} ${scope} ${arg_DEPENDS} ${arg_LIBRARIES} airtruth_options)
  if(arg_PRIVATE_LIBRARIES)
    target_link_libraries(airtruth_${name} PRIVATE ${arg_PRIVATE_LIBRARIES})
  endif()
  set_property(GLOBAL APPEND PROPERTY AIRTRUTH_MODULES airtruth_${name})
  if(AIRTRUTH_TESTS)
    if(arg_TESTS)
      add_module_test(${name}_test fast ${name} "${arg_TESTS}" "${arg_TEST_DEPENDS};${arg_PRIVATE_LIBRARIES}")
    endif()
    if(arg_SLOW_TESTS AND NOT AIRTRUTH_SANITIZE)
      add_module_test(${name}_slow_test slow ${name} "${arg_SLOW_TESTS}" "${arg_TEST_DEPENDS};${arg_PRIVATE_LIBRARIES}")
    endif()
  endif()
endfunction()

function(add_module_test target label module sources libraries)
  add_executable(${target} ${sources})
  target_link_libraries(${target} PRIVATE airtruth_${module} ${libraries} GTest::gmock GTest::gtest_main)
  add_test(NAME ${target} COMMAND ${target})
  set_tests_properties(${target} PROPERTIES
    LABELS ${label} TIMEOUT 900
    ENVIRONMENT "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan.supp:print_suppressions=0;ASAN_OPTIONS=detect_leaks=1")
endfunction()
