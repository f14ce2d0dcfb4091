# The libraries of the hardware and the scenes as rtusim::NAME, here and for other projects; and what `cmake --install` installs: the program,
# the pictures' library, and those libraries with their headers and rtusimConfig.cmake.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(exported rtusim_options)
get_property(rooms DIRECTORY modules PROPERTY SUBDIRECTORIES)
foreach(room ${rooms} ${PROJECT_SOURCE_DIR}/scenes)
  get_property(libraries DIRECTORY ${room} PROPERTY BUILDSYSTEM_TARGETS)
  list(APPEND exported ${libraries})
endforeach()
foreach(library ${exported})
  string(REGEX REPLACE "^rtusim_" "" name ${library})
  add_library(rtusim::${name} ALIAS ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
endforeach()

# Sources include "modules/...", so a user's include folder is the one that holds them.
set(headers ${CMAKE_INSTALL_INCLUDEDIR}/rtusim)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/rtusim)
target_include_directories(rtusim_options INTERFACE $<INSTALL_INTERFACE:${headers}>)
install(DIRECTORY modules scenes DESTINATION ${headers} FILES_MATCHING PATTERN *.h PATTERN data EXCLUDE PATTERN pictures EXCLUDE)
install(TARGETS ${exported} EXPORT rtusimTargets)
install(EXPORT rtusimTargets NAMESPACE rtusim:: DESTINATION ${package})
write_basic_package_version_file(rtusimConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/rtusimConfig.cmake ${PROJECT_BINARY_DIR}/rtusimConfigVersion.cmake DESTINATION ${package})

# The program looks for the library beside itself, and there: see testbench/pictures/picture_library.h.
install(TARGETS rtusim)
install(TARGETS rtusim_pictures LIBRARY DESTINATION lib/rtusim)
