# Manual pages and bash completion, which the program writes from its own help; compressed as Debian wants them.
find_program(GZIP gzip REQUIRED)
set(manual ${PROJECT_BINARY_DIR}/manual)
add_custom_command(OUTPUT ${manual}/airtruth.bash
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${manual}
  COMMAND ${CMAKE_COMMAND} -E env ASAN_OPTIONS=detect_leaks=0 $<TARGET_FILE:airtruth> describe ${manual}
  COMMAND ${CMAKE_COMMAND} -DGZIP=${GZIP} -DFOLDER=${manual}/man1 -P ${PROJECT_SOURCE_DIR}/cmake/compress_pages.cmake
  DEPENDS airtruth ${PROJECT_SOURCE_DIR}/cmake/compress_pages.cmake
  COMMENT "Writing manual pages and bash completion"
  VERBATIM)
add_custom_target(manual ALL DEPENDS ${manual}/airtruth.bash)
install(DIRECTORY ${manual}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR})
install(FILES ${manual}/airtruth.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME airtruth)

# The changelogs of Debian and of the program itself, and the licences.
set(changelogs ${PROJECT_BINARY_DIR}/changelogs)
add_custom_command(OUTPUT ${changelogs}/changelog.gz ${changelogs}/changelog.Debian.gz
  COMMAND ${CMAKE_COMMAND} -E make_directory ${changelogs}
  COMMAND sh -c "${GZIP} -9nc '${PROJECT_SOURCE_DIR}/CHANGELOG.md' > changelog.gz"
  COMMAND sh -c "${GZIP} -9nc '${PROJECT_SOURCE_DIR}/packaging/debian/changelog' > changelog.Debian.gz"
  DEPENDS ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/packaging/debian/changelog
  WORKING_DIRECTORY ${PROJECT_BINARY_DIR}/changelogs
  VERBATIM)
add_custom_target(changelogs ALL DEPENDS ${changelogs}/changelog.gz ${changelogs}/changelog.Debian.gz)
file(MAKE_DIRECTORY ${changelogs})
install(FILES ${changelogs}/changelog.gz ${changelogs}/changelog.Debian.gz ${PROJECT_SOURCE_DIR}/packaging/debian/copyright
  DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/packaging/debian/lintian-overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
  RENAME airtruth)
