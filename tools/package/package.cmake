# `cpack` in a build directory makes a Debian package that needs nothing but runtime libraries.
include(GNUInstallDirs)
install(TARGETS knap RUNTIME)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tools/package/knap.1)
execute_process(COMMAND gzip -9nc ${CMAKE_SOURCE_DIR}/tools/package/knap.1 OUTPUT_FILE ${CMAKE_BINARY_DIR}/knap.1.gz COMMAND_ERROR_IS_FATAL ANY)  # -n: no time in it
install(FILES ${CMAKE_BINARY_DIR}/knap.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES tools/package/knap.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME knap)
install(FILES tools/package/copyright README.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the authors of knap")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "2D dynamic fracture with nonsmooth cohesive interfaces")
set(CPACK_PACKAGE_DESCRIPTION "Meshes a body, lets waves and cracks run through it with a cohesive interface on every edge of the mesh,
 contact, friction and impact included, and draws crack patterns and energy curves. One scenario file, one command.")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS fonts-dejavu-core)  # found at run time, by name
include(CPack)
