# Tests of the ROS side. Plain ones need no master; the others are run by rostest, which starts its own.

file(GLOB ros_unit_tests CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/test/ros/*_test.cpp)
mba_vo_test(mba_vo_ros_test SOURCES ${ros_unit_tests} src/nodelets/tracker_console.cpp DEPENDS mba_vo_ros)
mba_vo_ros_target(mba_vo_ros_test)
target_include_directories(mba_vo_ros_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src/nodelets)

add_test(NAME mba_vo_exposure_relay
  COMMAND ${PYTHON_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/test/ros/exposure_relay_test.py)
set_tests_properties(mba_vo_exposure_relay PROPERTIES TIMEOUT 120
  ENVIRONMENT "PYTHONPATH=${CATKIN_DEVEL_PREFIX}/${PYTHON_INSTALL_DIR}:$ENV{PYTHONPATH}")

find_program(MBA_VO_ROSTEST rostest)
if(NOT MBA_VO_ROSTEST)
  message(STATUS "rostest not found: the tests with a ROS master are left out")
  return()
endif()

set(ros_test_folder ${CMAKE_CURRENT_SOURCE_DIR}/test/ros/rostest)
set(ros_test_environment
  "PATH=/usr/bin:$ENV{PATH}"  # the system's Python
  "ROS_IP=127.0.0.1"
  "ROS_HOME=${CMAKE_CURRENT_BINARY_DIR}/ros_home"
  "ROS_PACKAGE_PATH=${CMAKE_CURRENT_SOURCE_DIR}:/usr/share:$ENV{ROS_PACKAGE_PATH}"
  "CMAKE_PREFIX_PATH=${CATKIN_DEVEL_PREFIX}:$ENV{CMAKE_PREFIX_PATH}"
  "LD_LIBRARY_PATH=${CATKIN_DEVEL_PREFIX}/lib:$ENV{LD_LIBRARY_PATH}"
  "PYTHONPATH=${CATKIN_DEVEL_PREFIX}/${PYTHON_INSTALL_DIR}:$ENV{PYTHONPATH}")

# What several of them share: nodelets in a process of their own, a bag, a camera.
add_library(mba_vo_rostest_common STATIC ${ros_test_folder}/demo_sequence.cpp ${ros_test_folder}/live_odometry.cpp
  ${ros_test_folder}/sequence_camera.cpp)
mba_vo_ros_target(mba_vo_rostest_common)
target_include_directories(mba_vo_rostest_common PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/test)
target_link_libraries(mba_vo_rostest_common PUBLIC mba_vo_ros mba_vo_evaluation GTest::gtest)

# Builds test/ros/rostest/<name>_test.cpp as the node mba_vo_<name>_test and runs <name>.test with it. Never with --text:
# rostest then takes failed tests for passed ones.
function(mba_vo_rostest name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;ARGS" ${ARGN})
  set(node mba_vo_${name}_test)
  add_executable(${node} ${ros_test_folder}/${name}_test.cpp ${ARG_SOURCES})
  mba_vo_ros_target(${node})
  target_include_directories(${node} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/test)
  target_link_libraries(${node} PRIVATE mba_vo_rostest_common)
  add_dependencies(${node} mba_vo_nodelets)
  add_test(NAME mba_vo_rostest_${name} COMMAND ${PYTHON_EXECUTABLE} ${MBA_VO_ROSTEST}
    ${ros_test_folder}/${name}.test ${ARG_ARGS})
  # One at a time, beside others, of which there are many: so the first begins at once.
  set_tests_properties(mba_vo_rostest_${name} PROPERTIES RESOURCE_LOCK ros_nodes COST 1000 TIMEOUT ${ARG_TIMEOUT}
    ENVIRONMENT "${ros_test_environment}")
endfunction()

mba_vo_rostest(bad_input TIMEOUT 320 SOURCES ${ros_test_folder}/bad_topics_test.cpp)
mba_vo_rostest(camera TIMEOUT 120)
set(bag_folder folder:=${CMAKE_CURRENT_BINARY_DIR}/play_bag_test)
mba_vo_rostest(play_bag TIMEOUT 520 ARGS ${bag_folder})
mba_vo_rostest(deblurring TIMEOUT 320 ARGS ${bag_folder})
mba_vo_rostest(lifecycle TIMEOUT 520 SOURCES ${ros_test_folder}/saved_map_test.cpp
  ${ros_test_folder}/extrinsic_test.cpp ARGS ${bag_folder})
mba_vo_rostest(views TIMEOUT 320 ARGS ${bag_folder})
set_tests_properties(mba_vo_rostest_deblurring mba_vo_rostest_lifecycle mba_vo_rostest_views PROPERTIES
  DEPENDS mba_vo_rostest_play_bag)  # which makes the bag

add_test(NAME mba_vo_rostest_relay_presets COMMAND ${PYTHON_EXECUTABLE} ${MBA_VO_ROSTEST} ${ros_test_folder}/relay_presets.test)
set_tests_properties(mba_vo_rostest_relay_presets PROPERTIES TIMEOUT 320 ENVIRONMENT "${ros_test_environment}")

add_test(NAME bad_bags COMMAND ${PYTHON_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/test/ros/bad_bags_test.py
  ${CMAKE_CURRENT_SOURCE_DIR}/tools/ros/play_bag)
set_tests_properties(bad_bags PROPERTIES TIMEOUT 300 ENVIRONMENT "${ros_test_environment}")

add_test(NAME launch_files COMMAND ${PYTHON_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/test/ros/launch_files_test.py)
set_tests_properties(launch_files PROPERTIES ENVIRONMENT "${ros_test_environment}")

# Nodes of the package as it is installed and moved elsewhere by test/package/package_test.cmake.
set(installed ${CMAKE_CURRENT_BINARY_DIR}/.package_test/moved)
set(installed_environment
  "PATH=/usr/bin:$ENV{PATH}"
  "ROS_IP=127.0.0.1"
  "ROS_HOME=${CMAKE_CURRENT_BINARY_DIR}/ros_home"
  "ROS_PACKAGE_PATH=${installed}/share:/usr/share"
  "CMAKE_PREFIX_PATH=${installed}"
  "LD_LIBRARY_PATH=${installed}/lib"
  "PYTHONPATH=${installed}/${PYTHON_INSTALL_DIR}")
add_test(NAME mba_vo_rostest_install_space COMMAND ${PYTHON_EXECUTABLE} ${MBA_VO_ROSTEST}
  ${ros_test_folder}/install_space.test)
# If a required node dies all is shut down, and publishtest does not mind.
set_tests_properties(mba_vo_rostest_install_space PROPERTIES FAIL_REGULAR_EXPRESSION "has died|Failed to load"
  TIMEOUT 320 FIXTURES_REQUIRED installed_package ENVIRONMENT "${installed_environment}")

# The package in a catkin workspace, of the objects that were built here.
find_program(MBA_VO_CATKIN_MAKE catkin_make)
if(MBA_VO_CATKIN_MAKE AND NOT MBA_VO_SANITIZE AND NOT MBA_VO_VECTORS)
  add_test(NAME catkin_workspace COMMAND ${CMAKE_COMMAND} -DBUILD_DIR=${CMAKE_CURRENT_BINARY_DIR}
    -DSOURCE_DIR=${CMAKE_CURRENT_SOURCE_DIR} -DWORK_DIR=${CMAKE_CURRENT_BINARY_DIR}/.workspace_test
    -DCATKIN_MAKE=${MBA_VO_CATKIN_MAKE} -DBUILD_TYPE=${CMAKE_BUILD_TYPE} -DUNITY=$<BOOL:${CMAKE_UNITY_BUILD}>
    -P ${CMAKE_CURRENT_SOURCE_DIR}/test/package/workspace_test.cmake)
  set_tests_properties(catkin_workspace PROPERTIES TIMEOUT 900 ENVIRONMENT
    "PATH=/usr/bin:$ENV{PATH};ROS_IP=127.0.0.1;ROS_HOME=${CMAKE_CURRENT_BINARY_DIR}/ros_home")
endif()

find_program(MBA_VO_CATKIN_LINT catkin_lint)
if(MBA_VO_CATKIN_LINT)
  add_test(NAME catkin_lint COMMAND ${MBA_VO_CATKIN_LINT} -W1 --strict --offline --quiet ${CMAKE_CURRENT_SOURCE_DIR})
endif()

# Images that were compressed without loss, offline: the trajectory of the originals, byte by byte.
add_test(NAME compressed_offline COMMAND ${PYTHON_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/test/ros/compressed_offline_test.py
  $<TARGET_FILE:mba_vo_simulate> $<TARGET_FILE:mba_vo_offline> $<TARGET_FILE:mba_vo_deblur_program>)
set_tests_properties(compressed_offline PROPERTIES TIMEOUT 320 ENVIRONMENT "${ros_test_environment}")

# Bags that are each spoilt in one way: each fault must be named, and no other.
add_test(NAME check_names_what_is_wrong_with_bags COMMAND ${PYTHON_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/scripts/spoil.py
  --output ${CMAKE_CURRENT_BINARY_DIR}/spoilt_bags --check $<TARGET_FILE:mba_vo_check>)
set_tests_properties(check_names_what_is_wrong_with_bags PROPERTIES TIMEOUT 320 ENVIRONMENT "${ros_test_environment}")
