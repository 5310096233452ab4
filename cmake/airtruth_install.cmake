# Installs the program, the library libairtruth.so with its headers, and find_package(airtruth); CPack makes the .deb.
get_property(modules GLOBAL PROPERTY AIRTRUTH_MODULES)
set(objects "")
foreach(module IN LISTS modules)
  get_target_property(type ${module} TYPE)
  if(type STREQUAL STATIC_LIBRARY)
    list(APPEND objects $<TARGET_OBJECTS:${module}>)
  endif()
endforeach()
add_library(airtruth_shared SHARED ${objects})
set_target_properties(airtruth_shared PROPERTIES LINKER_LANGUAGE CXX)
set_target_properties(airtruth_shared PROPERTIES OUTPUT_NAME airtruth EXPORT_NAME airtruth
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
target_link_libraries(airtruth_shared PRIVATE ${modules})
target_link_libraries(airtruth_shared INTERFACE Eigen3::Eigen)
target_compile_features(airtruth_shared INTERFACE cxx_std_20)
target_include_directories(airtruth_shared INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/airtruth>)
add_library(airtruth::airtruth ALIAS airtruth_shared)

include(CMakePackageConfigHelpers)
install(TARGETS airtruth RUNTIME)
install(TARGETS airtruth-model-reader RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/airtruth)
install(TARGETS airtruth_shared EXPORT airtruth LIBRARY)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/airtruth
  FILES_MATCHING PATTERN "*.h" PATTERN "cli" EXCLUDE PATTERN "model_reader" EXCLUDE PATTERN "picture_kinds.h" EXCLUDE PATTERN "table_reader.h" EXCLUDE PATTERN "tables.h" EXCLUDE PATTERN "xml_file.h" EXCLUDE
  PATTERN "small_catalogue.h" EXCLUDE)
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
install(EXPORT airtruth NAMESPACE airtruth:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/airtruth FILE airtruth-targets.cmake)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/airtruth-config.cmake.in
  ${PROJECT_BINARY_DIR}/airtruth-config.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/airtruth)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/airtruth-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/airtruth-config.cmake ${PROJECT_BINARY_DIR}/airtruth-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/airtruth)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The airtruth developers <airtruth@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
file(READ ${PROJECT_SOURCE_DIR}/packaging/description.txt CPACK_DEBIAN_PACKAGE_DESCRIPTION)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/packaging/description.txt)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "flightgear-data-ai, libgl1-mesa-dri, libegl-mesa0")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libeigen3-dev, gnuplot-nox")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/debian/triggers)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
include(CPack)
