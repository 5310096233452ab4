# For tests and for the sources of the program: what they call is optimised (decision 0011).
set(airtruth_light_optimisation $<IF:$<BOOL:${AIRTRUTH_SANITIZE}>,-O0,-O1>)

# Headers that nearly every file reads, compiled once for libraries and once for tests. Every file includes what it
# uses all the same: -DAIRTRUTH_PCH=OFF builds without.
if(AIRTRUTH_PCH)
  set(airtruth_common_headers
              <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional> <span> <sstream>
              <string> <variant> <vector> <Eigen/Core> <Eigen/Geometry> <fmt/format.h> <fmt/ranges.h>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL Clang)
    # Clang keeps the Eigen expressions that their inline functions instantiate; GCC instantiates them anew in every source.
    list(APPEND airtruth_common_headers
                <foundation/base/error.h> <foundation/geometry/within_frame.h> <foundation/geometry/box.h>
                <foundation/image/layer.h> <foundation/image/picture.h> <camera/lens/lens.h> <aircraft/model/mesh.h>)
  endif()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/pch.cpp CONTENT "")
  add_library(airtruth_pch STATIC ${PROJECT_BINARY_DIR}/pch.cpp)
  target_link_libraries(airtruth_pch PRIVATE airtruth_options Eigen3::Eigen)
  target_include_directories(airtruth_pch PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_precompile_headers(airtruth_pch PRIVATE ${airtruth_common_headers})
  if(AIRTRUTH_TESTS)
    add_executable(airtruth_test_pch ${PROJECT_BINARY_DIR}/pch.cpp)
    target_link_libraries(airtruth_test_pch PRIVATE airtruth_options Eigen3::Eigen GTest::gmock GTest::gtest_main)
    target_include_directories(airtruth_test_pch PRIVATE ${PROJECT_SOURCE_DIR}/src)
    target_compile_options(airtruth_test_pch PRIVATE ${airtruth_light_optimisation})
    target_precompile_headers(airtruth_test_pch PRIVATE ${airtruth_common_headers} <gmock/gmock.h> <gtest/gtest.h>)
  endif()
endif()

# Most of a compiler's time goes into headers, which sources that are compiled as one read once. Their private names must
# differ from each other; a source whose names have to clash sets SKIP_UNITY_BUILD_INCLUSION.
function(compile_sources_together target)
  if(AIRTRUTH_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  endif()
endfunction()

# add_module(NAME SOURCES a.cpp ... [DEPENDS module ...] [LIBRARIES target ...] [PRIVATE_LIBRARIES target ...]
#            [TESTS a_test.cpp ...] [TEST_DEPENDS target ...] [SLOW_TESTS b_test.cpp ...]
#            [UNSANITIZED Suite.Name ...])
# makes the static library airtruth_NAME and, from TESTS, the program NAME_test (one ctest entry; SLOW_TESTS
# make NAME_slow_test, labelled slow; not with sanitizers, under which they take hours). UNSANITIZED Suite.Name ... names
# tests of NAME_test that are left out with sanitizers: they repeat, for their statistics or in
# whole runs, what other tests run.
function(add_module name)
  cmake_parse_arguments(arg "" ""
    "SOURCES;DEPENDS;LIBRARIES;PRIVATE_LIBRARIES;TESTS;TEST_DEPENDS;SLOW_TESTS;UNSANITIZED" ${ARGN})
  if(arg_SOURCES)
    add_library(airtruth_${name} STATIC ${arg_SOURCES})
    compile_sources_together(airtruth_${name})
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
  if(AIRTRUTH_PCH AND arg_SOURCES)
    target_precompile_headers(airtruth_${name} REUSE_FROM airtruth_pch)
  endif()
  set_property(GLOBAL APPEND PROPERTY AIRTRUTH_MODULES airtruth_${name})
  if(AIRTRUTH_TESTS)
    if(arg_TESTS)
      add_module_test(${name}_test fast ${name} "${arg_TESTS}" "${arg_TEST_DEPENDS};${arg_PRIVATE_LIBRARIES}")
      if(arg_UNSANITIZED AND AIRTRUTH_SANITIZE)
        list(JOIN arg_UNSANITIZED ":" left_out)
        set_property(TEST ${name}_test APPEND PROPERTY ENVIRONMENT "GTEST_FILTER=-${left_out}")
      endif()
    endif()
    if(arg_SLOW_TESTS AND NOT AIRTRUTH_SANITIZE)
      add_module_test(${name}_slow_test slow ${name} "${arg_SLOW_TESTS}" "${arg_TEST_DEPENDS};${arg_PRIVATE_LIBRARIES}")
    endif()
  endif()
endfunction()

# add_lazy_library(NAME SOURCES a.cpp ... LIBRARIES target ...) makes airtruth-late-NAME.so, which stands beside the
# program and is loaded when it is first needed (src/foundation/lazy_library/lazy_library.h).
function(add_lazy_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_library(airtruth-late-${name} MODULE ${arg_SOURCES})
  set_target_properties(airtruth-late-${name} PROPERTIES PREFIX "" BUILD_RPATH ""
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/src/cli)
  target_link_libraries(airtruth-late-${name} PRIVATE airtruth_options ${arg_LIBRARIES})
  target_include_directories(airtruth-late-${name} PRIVATE ${PROJECT_SOURCE_DIR}/src)
endfunction()

function(add_module_test target label module sources libraries)
  add_executable(${target} ${sources})
  target_link_libraries(${target} PRIVATE airtruth_${module} ${libraries} GTest::gmock GTest::gtest_main)
  target_compile_options(${target} PRIVATE ${airtruth_light_optimisation})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/tests)  # for <support/...>
  if(AIRTRUTH_PCH)
    target_precompile_headers(${target} REUSE_FROM airtruth_test_pch)
  endif()
  # The first reads the model files of tests.
  add_dependencies(${target} airtruth-model-reader airtruth-late-opencv airtruth-late-backdrop)
  add_test(NAME ${target} COMMAND ${target})
  # A limit stops a test that hangs: ten times and more what the longest of its label takes on two quiet cores.
  set(limit_s 600)
  if(label STREQUAL slow)
    set(limit_s 3600)
  endif()
  set_tests_properties(${target} PROPERTIES
    LABELS ${label} TIMEOUT ${limit_s}
    ENVIRONMENT "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan.supp:print_suppressions=0;ASAN_OPTIONS=detect_leaks=1;AIRTRUTH_MODEL_READER=${PROJECT_BINARY_DIR}/src/cli/airtruth-model-reader;AIRTRUTH_NETWORK_RUNNER=${PROJECT_BINARY_DIR}/src/cli/airtruth-network-runner")
  if(label STREQUAL slow)
    set_tests_properties(${target} PROPERTIES COST 100)  # begun first, so that none is left alone at the end
  endif()
endfunction()
