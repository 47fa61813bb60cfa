# `cpack` in a build directory makes two packages: a Debian package that needs nothing but runtime libraries, and a relocatable archive for
# those without root, which brings its libraries (all but glibc's) and its font. `cpack -G DEB` or `cpack -G TXZ` makes one of them.
include(GNUInstallDirs)
set(for_both COMPONENT knap)
set(for_archive COMPONENT archive EXCLUDE_FROM_ALL)

# DT_RPATH, not DT_RUNPATH: libraries find those that they need at the same place. The Debian package has nothing there.
set_target_properties(knap PROPERTIES INSTALL_RPATH "$ORIGIN/../lib/knap")
target_link_options(knap PRIVATE LINKER:--disable-new-dtags)
install(TARGETS knap RUNTIME ${for_both})
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tools/package/knap.1)
execute_process(COMMAND gzip -9nc ${CMAKE_SOURCE_DIR}/tools/package/knap.1 OUTPUT_FILE ${CMAKE_BINARY_DIR}/knap.1.gz COMMAND_ERROR_IS_FATAL ANY)  # -n: no time in it
install(FILES ${CMAKE_BINARY_DIR}/knap.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 ${for_both})
set(CPACK_PACKAGE_CONTACT "The authors of knap <maintainers@users.noreply.h-seed-75b4ef65.example>")
file(STRINGS ${CMAKE_SOURCE_DIR}/CITATION.cff released REGEX "^date-released")
string(REGEX REPLACE "date-released: *" "" released "${released}")
execute_process(COMMAND ${CMAKE_COMMAND} -E env LC_ALL=C date -R -u -d ${released} OUTPUT_VARIABLE released OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
file(WRITE ${CMAKE_BINARY_DIR}/changelog "knap (${PROJECT_VERSION}) unstable; urgency=medium

  * What a user notices: CHANGELOG.md.

 -- ${CPACK_PACKAGE_CONTACT}  ${released}
")
execute_process(COMMAND gzip -9nc ${CMAKE_BINARY_DIR}/changelog OUTPUT_FILE ${CMAKE_BINARY_DIR}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)
install(FILES ${CMAKE_BINARY_DIR}/changelog.gz DESTINATION ${CMAKE_INSTALL_DOCDIR} ${for_both})
install(FILES tools/package/knap.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME knap ${for_both})
install(FILES tools/package/_knap DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions ${for_both})
install(FILES tools/package/knap.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d ${for_both})
install(FILES tools/python/knap.py DESTINATION ${CMAKE_INSTALL_DATADIR}/knap ${for_both})
install(DIRECTORY tools/python DESTINATION ${CMAKE_INSTALL_DATADIR}/knap ${for_both} USE_SOURCE_PERMISSIONS
        PATTERN __pycache__ EXCLUDE PATTERN build EXCLUDE PATTERN *.egg-info EXCLUDE)  # for pip install
install(FILES tools/package/copyright README.md CHANGELOG.md CITATION.cff codemeta.json LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} ${for_both})
# the pages and what they link to, in the places where they link to it
file(GLOB_RECURSE pages RELATIVE ${CMAKE_SOURCE_DIR} CONFIGURE_DEPENDS src/*.md scenarios/*.md scenarios/*.toml tests/*.md
     tests/verification/*.png tests/verification/*.csv tests/lcp/*.csv tests/stepper/absorbing.cpp tests/stepper/adapt/excavation.cpp third_party_notes/*.md
     tools/bench/*.md tools/bench/*.csv scenarios/results/*.csv scenarios/fits/*.csv tools/browser/*.md
     tools/python/*.py tools/python/*.ipynb)
foreach(page ${pages})
  get_filename_component(folder ${page} DIRECTORY)
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder} ${for_both})
endforeach()

install(CODE "set(pages \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DOCDIR}\")" ${for_both})
install(SCRIPT tools/package/without_gallery.cmake ${for_both})

find_file(KNAP_FONT DejaVuSans.ttf PATHS /usr/share/fonts/truetype/dejavu)
find_file(KNAP_FONT_BOLD DejaVuSans-Bold.ttf PATHS /usr/share/fonts/truetype/dejavu)
if(KNAP_FONT AND KNAP_FONT_BOLD)
  install(FILES tools/package/fonts.conf DESTINATION ${CMAKE_INSTALL_DATADIR}/knap ${for_archive})
  install(FILES ${KNAP_FONT} ${KNAP_FONT_BOLD} DESTINATION ${CMAKE_INSTALL_DATADIR}/knap/fonts ${for_archive})
endif()
install(CODE "set(program \"$<TARGET_FILE:knap>\")\nset(fonts \"${KNAP_FONT}\")" ${for_archive})
install(SCRIPT tools/package/libraries.cmake ${for_archive})

set(CPACK_GENERATOR DEB TXZ)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "2D dynamic fracture with nonsmooth cohesive interfaces")
set(CPACK_PACKAGE_DESCRIPTION "Meshes a body, lets waves and cracks run through it with a cohesive
 interface on every edge of the mesh, contact, friction and impact included,
 and draws crack patterns and energy curves. One scenario file, one command.")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS python3-numpy)  # of knap.py
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "python3-scipy, python3-matplotlib, python3-sklearn, python3-emcee")  # of knap-fit
set(CPACK_DEBIAN_PACKAGE_DEPENDS "fonts-dejavu-core, python3:any")  # the font is found at run time, by name; scripts in share/knap/python
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_SOURCE_DIR}/tools/package/generator.cmake)
include(CPack)
