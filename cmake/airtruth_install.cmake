# Installs the program, the libraries with their public headers, and find_package(airtruth); CPack makes the .deb.

# Adds a shared library of the public API: airtruth_library(NAME OUTPUT MODULES m... HEADERS h...). MODULES are those that
# export something (AIRTRUTH_API); their objects go in whole, and the linker takes what these need from the others.
function(airtruth_library name output)
  cmake_parse_arguments(arg "" "" "MODULES;HEADERS" ${ARGN})
  list(TRANSFORM arg_MODULES PREPEND airtruth_)
  set(objects "")
  foreach(module IN LISTS arg_MODULES)
    list(APPEND objects $<TARGET_OBJECTS:${module}>)
  endforeach()
  add_library(airtruth_${name}_shared SHARED ${objects})
  # Before version 1.0 a new minor version may break programs, so it has an SONAME of its own.
  set(soversion ${PROJECT_VERSION_MAJOR})
  if(soversion EQUAL 0)
    set(soversion 0.${PROJECT_VERSION_MINOR})
  endif()
  set_target_properties(airtruth_${name}_shared PROPERTIES LINKER_LANGUAGE CXX
    OUTPUT_NAME ${output} EXPORT_NAME ${name} VERSION ${PROJECT_VERSION} SOVERSION ${soversion})
  target_link_libraries(airtruth_${name}_shared PRIVATE ${arg_MODULES})
  set(exports ${PROJECT_SOURCE_DIR}/cmake/exports.map)
  target_link_options(airtruth_${name}_shared PRIVATE -Wl,--version-script=${exports}
    # What comes out of an archive is not for export, though gcc gives functions of several versions (vectors.h) to all.
    -Wl,--exclude-libs,ALL)
  set_target_properties(airtruth_${name}_shared PROPERTIES LINK_DEPENDS ${exports})
  target_compile_features(airtruth_${name}_shared INTERFACE cxx_std_20)
  target_include_directories(airtruth_${name}_shared INTERFACE
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
    $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  add_library(airtruth::${name} ALIAS airtruth_${name}_shared)
  install(TARGETS airtruth_${name}_shared EXPORT airtruth-${name} LIBRARY COMPONENT ${name})
  install(EXPORT airtruth-${name} NAMESPACE airtruth:: FILE airtruth-${name}-targets.cmake
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/airtruth COMPONENT ${name})
  list(TRANSFORM arg_HEADERS PREPEND ${PROJECT_SOURCE_DIR}/include/airtruth/)
  list(TRANSFORM arg_HEADERS APPEND .h)
  install(FILES ${arg_HEADERS} ${PROJECT_BINARY_DIR}/include/airtruth/version.h
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/airtruth COMPONENT ${name})
endfunction()

# Metrics and formats for authors of trackers: without OpenSceneGraph, Embree, OpenCV and codecs. It can be installed by
# itself: cmake --install BUILD --component evaluation.
set(evaluation_modules base matching statistics measures label_file exchange records)
set(evaluation_headers aot average_precision box dataset error export froc labels lens metrics statistics track_measures truth vot)
airtruth_library(evaluation airtruth-evaluation MODULES ${evaluation_modules} HEADERS ${evaluation_headers})
# All of it.
airtruth_library(airtruth airtruth
  MODULES ${evaluation_modules} clips flights pictures
  HEADERS ${evaluation_headers} aircraft calibration encounters motion picture renderer stream video)

include(CMakePackageConfigHelpers)
install(TARGETS airtruth RUNTIME)
install(TARGETS airtruth-model-reader airtruth-network-runner RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/airtruth)
install(TARGETS airtruth-late-opencv airtruth-late-backdrop LIBRARY DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/airtruth)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/airtruth/examples)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/clients/ DESTINATION ${CMAKE_INSTALL_DATADIR}/airtruth/clients
  PATTERN CMakeLists.txt EXCLUDE PATTERN __pycache__ EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/catalogues/ DESTINATION ${CMAKE_INSTALL_DATADIR}/airtruth/catalogues)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/airtruth/data)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/formats/ DESTINATION ${CMAKE_INSTALL_DATADIR}/airtruth/schemas
  FILES_MATCHING PATTERN "*.schema.json")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
include(airtruth_manual)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/airtruth-config.cmake.in
  ${PROJECT_BINARY_DIR}/airtruth-config.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/airtruth)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/airtruth-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/airtruth-config.cmake ${PROJECT_BINARY_DIR}/airtruth-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/airtruth COMPONENT evaluation)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The airtruth developers <airtruth@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
file(READ ${PROJECT_SOURCE_DIR}/packaging/description.txt CPACK_DEBIAN_PACKAGE_DESCRIPTION)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/packaging/description.txt)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "flightgear-data-ai, libgl1-mesa-dri, libegl-mesa0${AIRTRUTH_PYTHON_DEPENDS}")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "gnuplot-nox")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/debian/triggers)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
include(CPack)
