# Read by cpack for each kind of package: what goes into it, and its name.
if(CPACK_GENERATOR STREQUAL "TXZ")
  string(TOLOWER "knap-${CPACK_PACKAGE_VERSION}-${CPACK_SYSTEM_NAME}-${CMAKE_HOST_SYSTEM_PROCESSOR}" CPACK_PACKAGE_FILE_NAME)
  list(GET CPACK_INSTALL_CMAKE_PROJECTS 0 build)
  set(CPACK_INSTALL_CMAKE_PROJECTS "${build};knap;knap;/;${build};knap;archive;/")
endif()
