# Install rules: core libraries, headers and programs, and with ROS everything a package needs to be run from its install
# space.

include(GNUInstallDirs)
get_property(programs GLOBAL PROPERTY MBA_VO_PROGRAMS)
get_property(modules GLOBAL PROPERTY MBA_VO_MODULES)
set(libraries)
foreach(module ${modules})
  get_target_property(type ${module} TYPE)
  if(NOT type STREQUAL INTERFACE_LIBRARY)
    list(APPEND libraries ${module})
  endif()
endforeach()

if(MBA_VO_ROS)
  set(program_destination ${CATKIN_PACKAGE_BIN_DESTINATION})
  set(share_destination ${CATKIN_PACKAGE_SHARE_DESTINATION})
  list(APPEND libraries mba_vo_ros mba_vo_nodelets)
  install(FILES nodelet_plugins.xml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
  install(DIRECTORY launch rviz DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
  install(PROGRAMS tools/ros/exposure_relay tools/ros/play_bag DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
  install(FILES tools/ros/exposure_matching.py tools/ros/exposure_source.py  # of exposure_relay, found beside it
          DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
else()
  set(program_destination ${CMAKE_INSTALL_BINDIR})
  set(share_destination ${CMAKE_INSTALL_DATADIR}/${PROJECT_NAME})
endif()

if(programs)
  install(TARGETS ${programs} RUNTIME DESTINATION ${program_destination})
endif()
# lib, not lib/<architecture>: nodelet_plugins.xml names lib/libmba_vo_nodelets.
install(TARGETS ${libraries} ARCHIVE DESTINATION lib LIBRARY DESTINATION lib)
install(DIRECTORY include/mba_vo DESTINATION include FILES_MATCHING PATTERN "*.h")
install(DIRECTORY config DESTINATION ${share_destination})
install(FILES LICENSE DESTINATION ${share_destination})
