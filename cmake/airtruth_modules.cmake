# Wings that read, write and sort more than they compute: sanitized, they are not optimised, which takes half the time. In the
# others a test takes five times longer then.
set(AIRTRUTH_WINGS_WITHOUT_LOOPS foundation labels show dataset evaluation library studio cli)
# For tests and for the sources of the program: what they call is optimised (decision 0011).
set(airtruth_light_optimisation $<IF:$<BOOL:${AIRTRUTH_SANITIZE}>,-O0,-O1>)

# Headers that nearly every file reads, compiled once for libraries and once for tests. Every file includes what it
# uses all the same: -DAIRTRUTH_PCH=OFF builds without.
if(AIRTRUTH_PCH)
  set(airtruth_common_headers
              <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional> <span> <sstream>
              <string> <variant> <vector> <Eigen/Core> <Eigen/Geometry> <fmt/format.h> <fmt/ranges.h>)
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

# Most of a compiler's time goes into headers and templates, which sources that are compiled as one read and instantiate once.
# Their private names must differ from each other.
function(compile_sources_together target)
  if(AIRTRUTH_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${AIRTRUTH_UNITY})
  endif()
endfunction()

# add_module(NAME [APART] SOURCES a.cpp ... [DEPENDS module ...] [LIBRARIES target ...] [PRIVATE_LIBRARIES target ...]
#            [TESTS a_test.cpp ...] [TEST_DEPENDS target ...] [SLOW_TESTS b_test.cpp ...]
#            [SANITIZED_BEFORE_A_RELEASE Suite.Name ...] [OPTIMISATION flag ...])
# makes the library airtruth_NAME, and keeps its tests for the test programs of its wing (add_wing_tests). DEPENDS are the
# modules that its sources include, and no others (tests/layers_test.cpp). With AIRTRUTH_UNITY the module's sources are compiled
# with those of its wing, unless it stands APART: what goes into libairtruth-evaluation.so or into a child program without its
# wing, what the demo does without, and what has sources or definitions of its own making. OPTIMISATION is what inner loops are
# compiled with beyond the usual, which precompiled headers would undo. SLOW_TESTS are left out with sanitizers, under which they
# take hours. SANITIZED_BEFORE_A_RELEASE Suite.Name ... names tests that take seconds with sanitizers and repeat, for their
# statistics or in whole runs, what other tests run: with sanitizers they are tests of their own, labelled slow.
function(add_module name)
  cmake_parse_arguments(arg "APART" ""
    "SOURCES;DEPENDS;LIBRARIES;PRIVATE_LIBRARIES;TESTS;TEST_DEPENDS;SLOW_TESTS;SANITIZED_BEFORE_A_RELEASE;OPTIMISATION" ${ARGN})
  set(owner airtruth_${name})
  if(NOT arg_SOURCES)
    add_library(airtruth_${name} INTERFACE)
    set(scope INTERFACE)
  elseif(AIRTRUTH_UNITY AND NOT arg_APART AND NOT arg_OPTIMISATION)
    wing_library(owner)
    add_library(airtruth_${name} INTERFACE)
    target_link_libraries(airtruth_${name} INTERFACE ${owner})
    foreach(source IN LISTS arg_SOURCES)
      cmake_path(ABSOLUTE_PATH source)
      target_sources(${owner} PRIVATE ${source})
    endforeach()
    set(scope PUBLIC)
  else()
    add_library(airtruth_${name} STATIC ${arg_SOURCES})
    compile_sources_together(airtruth_${name})
    set(scope PUBLIC)
  endif()
  list(TRANSFORM arg_DEPENDS PREPEND airtruth_)
  target_include_directories(${owner} ${scope} ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(${owner} ${scope} ${arg_DEPENDS} ${arg_LIBRARIES} airtruth_options)
  if(arg_PRIVATE_LIBRARIES)
    target_link_libraries(${owner} PRIVATE ${arg_PRIVATE_LIBRARIES})
  endif()
  if(arg_OPTIMISATION AND NOT AIRTRUTH_SANITIZE)
    target_compile_options(${owner} PRIVATE ${arg_OPTIMISATION})
  elseif(AIRTRUTH_SANITIZE AND arg_SOURCES AND NOT arg_OPTIMISATION)
    wing_of_folder(wing)
    if(wing IN_LIST AIRTRUTH_WINGS_WITHOUT_LOOPS)
      target_compile_options(${owner} PRIVATE -O0)
    endif()
  elseif(AIRTRUTH_PCH AND arg_SOURCES)
    target_precompile_headers(${owner} REUSE_FROM airtruth_pch)
  endif()
  set_property(GLOBAL APPEND PROPERTY AIRTRUTH_MODULES airtruth_${name})
  set(libraries airtruth_${name} ${arg_TEST_DEPENDS} ${arg_PRIVATE_LIBRARIES})
  if(arg_TESTS)
    keep_tests(test "${arg_TESTS}" "${libraries}")
    wing_of_folder(wing)
    set_property(GLOBAL APPEND PROPERTY AIRTRUTH_SANITIZED_BEFORE_A_RELEASE_IN_${wing}_test ${arg_SANITIZED_BEFORE_A_RELEASE})
  endif()
  if(arg_SLOW_TESTS AND NOT AIRTRUTH_SANITIZE)
    keep_tests(slow_test "${arg_SLOW_TESTS}" "${libraries}")
  endif()
endfunction()

# wing_library(OUT): the library of the modules of the current folder's wing that are compiled together.
function(wing_library out)
  wing_of_folder(wing)
  set(library airtruth_${wing}_wing)
  if(NOT TARGET ${library})
    add_library(${library} STATIC)
    compile_sources_together(${library})
  endif()
  set(${out} ${library} PARENT_SCOPE)
endfunction()

# The wing of the current folder: foundation in src/foundation/base.
function(wing_of_folder out)
  file(RELATIVE_PATH wing ${PROJECT_SOURCE_DIR}/src ${CMAKE_CURRENT_SOURCE_DIR})
  string(REGEX REPLACE "/.*" "" wing ${wing})
  set(${out} ${wing} PARENT_SCOPE)
endfunction()

# The headers through which a program and its late libraries see the same types, as one number in the names of what these
# export: a library of other headers lacks the name, and is refused before anything in it is called.
file(GLOB_RECURSE headers ${PROJECT_SOURCE_DIR}/src/*.h ${PROJECT_SOURCE_DIR}/include/*.h)
set(AIRTRUTH_BUILD "${PROJECT_VERSION}")
foreach(header ${headers})
  file(SHA256 ${header} hash)
  string(SHA256 AIRTRUTH_BUILD "${AIRTRUTH_BUILD}${hash}")
endforeach()
string(SUBSTRING ${AIRTRUTH_BUILD} 0 16 AIRTRUTH_BUILD)

# add_lazy_library(NAME SOURCES a.cpp ... LIBRARIES target ...) makes airtruth-late-NAME.so, which stands beside the
# program and is loaded when it is first needed (src/foundation/lazy_library/lazy_library.h).
function(add_lazy_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_library(airtruth-late-${name} MODULE ${arg_SOURCES})
  set_target_properties(airtruth-late-${name} PROPERTIES PREFIX "" BUILD_RPATH ""
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/src/cli)
  # A library that calls nothing of libc by itself names it all the same, as Debian's policy asks.
  target_link_libraries(airtruth-late-${name} PRIVATE airtruth_options ${arg_LIBRARIES}
    -Wl,--push-state,--no-as-needed -lc -Wl,--pop-state)
  target_include_directories(airtruth-late-${name} PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_compile_definitions(airtruth-late-${name} PRIVATE AIRTRUTH_BUILD="${AIRTRUTH_BUILD}")
endfunction()

# Keeps test sources of the current folder for the program WING_KIND (kind: test or slow_test) of its wing.
function(keep_tests kind sources libraries)
  wing_of_folder(wing)
  list(TRANSFORM sources PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  set_property(GLOBAL APPEND PROPERTY AIRTRUTH_SOURCES_OF_${wing}_${kind} ${sources})
  set_property(GLOBAL APPEND PROPERTY AIRTRUTH_LIBRARIES_OF_${wing}_${kind} ${libraries})
endfunction()

# add_wing_tests(WING): the programs WING_test and WING_slow_test (labelled slow) from the tests of the wing's modules, each one
# ctest entry. One program a wing: most of what it costs to make a test program is its link.
function(add_wing_tests wing)
  foreach(kind IN ITEMS test slow_test)
    get_property(sources GLOBAL PROPERTY AIRTRUTH_SOURCES_OF_${wing}_${kind})
    get_property(libraries GLOBAL PROPERTY AIRTRUTH_LIBRARIES_OF_${wing}_${kind})
    if(sources)
      add_wing_test(${wing}_${kind} "${sources}" "${libraries}")
    endif()
  endforeach()
endfunction()

function(add_wing_test target sources libraries)
  list(REMOVE_DUPLICATES libraries)
  add_executable(${target} ${sources})
  compile_sources_together(${target})
  target_link_libraries(${target} PRIVATE ${libraries} airtruth_options GTest::gmock GTest::gtest_main)
  if(AIRTRUTH_SANITIZE)
    set(leak_check ${PROJECT_SOURCE_DIR}/tests/support/leak_check.cpp)
    set_source_files_properties(${leak_check} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    target_sources(${target} PRIVATE ${leak_check})
  endif()
  target_compile_options(${target} PRIVATE ${airtruth_light_optimisation})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/tests)  # for <support/...>
  if(AIRTRUTH_PCH)
    target_precompile_headers(${target} REUSE_FROM airtruth_test_pch)
  endif()
  add_dependencies(${target} airtruth_children)
  set_property(GLOBAL APPEND PROPERTY AIRTRUTH_TEST_PROGRAMS ${target})
  add_test(NAME ${target} COMMAND ${target})
  # A limit stops a test that hangs: ten times and more what the longest takes on two quiet cores.
  if(target MATCHES "_slow_test$")
    set_tests_properties(${target} PROPERTIES LABELS slow TIMEOUT 3600 COST 100)  # begun first, so that none is left alone at the end
  else()
    set_tests_properties(${target} PROPERTIES LABELS fast TIMEOUT 3600)
  endif()
  set(environment
    "AIRTRUTH_SOURCE_DIR=${PROJECT_SOURCE_DIR}"
    "AIRTRUTH_MODEL_READER=${PROJECT_BINARY_DIR}/src/cli/airtruth-model-reader"
    "AIRTRUTH_NETWORK_RUNNER=${PROJECT_BINARY_DIR}/src/cli/airtruth-network-runner")
  if(AIRTRUTH_SANITIZE)
    list(APPEND environment "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan.supp:print_suppressions=0"
      "ASAN_OPTIONS=detect_leaks=1")
    get_property(names GLOBAL PROPERTY AIRTRUTH_SANITIZED_BEFORE_A_RELEASE_IN_${target})
    if(names)
      list(JOIN names ":" later)
      add_test(NAME ${target}_before_a_release COMMAND ${target})
      set_tests_properties(${target}_before_a_release PROPERTIES LABELS slow TIMEOUT 3600 ENVIRONMENT
        "${environment};GTEST_FILTER=${later}")
      list(APPEND environment "GTEST_FILTER=-${later}")
    endif()
  endif()
  set_tests_properties(${target} PROPERTIES ENVIRONMENT "${environment}")
endfunction()
