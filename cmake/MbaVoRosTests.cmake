# Tests of the ROS side. Plain ones need no master; each test/ros/<name>.test is run by rostest, which starts its own.

file(GLOB ros_unit_tests CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/test/ros/*_test.cpp)
if(ros_unit_tests)
  mba_vo_test(mba_vo_ros_test SOURCES ${ros_unit_tests} DEPENDS mba_vo_ros)
  mba_vo_ros_target(mba_vo_ros_test)
endif()
