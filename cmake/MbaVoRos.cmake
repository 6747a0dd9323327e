# ROS 1: messages, nodelets, bag tools and launch tests.

# catkin needs the system's Python, whatever comes first in PATH.
if(EXISTS /usr/bin/python3)
  set(PYTHON_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "Python that ROS was installed for")
  set(Python3_EXECUTABLE ${PYTHON_EXECUTABLE} CACHE FILEPATH "Python that ROS was installed for")
endif()
# rosrun and roslaunch ignore programs below <package>/build, so a plain build puts its devel space beside it.
if(CMAKE_SOURCE_DIR STREQUAL CMAKE_CURRENT_SOURCE_DIR AND NOT DEFINED CATKIN_DEVEL_PREFIX)
  set(CATKIN_DEVEL_PREFIX ${CMAKE_CURRENT_SOURCE_DIR}/devel CACHE PATH "catkin's devel space")
endif()

set(MBA_VO_MESSAGE_PACKAGES geometry_msgs std_msgs)
find_package(catkin REQUIRED COMPONENTS camera_info_manager cv_bridge diagnostic_updater geometry_msgs image_transport
  message_generation nav_msgs nodelet pluginlib rosbag rosbag_storage roscpp roslib sensor_msgs std_msgs std_srvs tf2_ros
  visualization_msgs)

add_message_files(FILES ExposureMotion.msg ExposureStamped.msg MapperStatus.msg ReferenceSummary.msg Status.msg
  TrackedFrameSummary.msg)
add_service_files(FILES MapFile.srv)
generate_messages(DEPENDENCIES ${MBA_VO_MESSAGE_PACKAGES})
catkin_package(
  INCLUDE_DIRS include
  CATKIN_DEPENDS message_runtime roscpp ${MBA_VO_MESSAGE_PACKAGES}
  CFG_EXTRAS mba_vo-library.cmake)

function(mba_vo_ros_target target)
  mba_vo_options(${target})
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/include)
  target_include_directories(${target} SYSTEM PUBLIC
    ${CATKIN_DEVEL_PREFIX}/${CATKIN_GLOBAL_INCLUDE_DESTINATION} ${catkin_INCLUDE_DIRS})
  add_dependencies(${target} ${PROJECT_NAME}_generate_messages_cpp)
  set_target_properties(${target} PROPERTIES
    LIBRARY_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_LIB_DESTINATION}
    RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})
endfunction()

# Conversions, bag reading and writing: everything that needs no ROS master.
file(GLOB MBA_VO_ROS_SOURCES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/ros/*.cpp)
add_library(mba_vo_ros STATIC ${MBA_VO_ROS_SOURCES})
set_source_files_properties(src/ros/intra_process_messages.cpp PROPERTIES
  SKIP_UNITY_BUILD_INCLUSION ON)  # test/package/reuse_object.sh tells it by its name
mba_vo_ros_target(mba_vo_ros)
target_link_libraries(mba_vo_ros PUBLIC mba_vo_capture mba_vo_inspection mba_vo_simulation ${catkin_LIBRARIES})

# The nodelets, two of them in one process for rosrun, and the manager of the launch files.
file(GLOB MBA_VO_NODELET_SOURCES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/nodelets/*.cpp)
if(MBA_VO_NODELET_SOURCES)
  add_library(mba_vo_nodelets SHARED ${MBA_VO_NODELET_SOURCES})
  mba_vo_ros_target(mba_vo_nodelets)
  target_link_libraries(mba_vo_nodelets PUBLIC mba_vo_ros)
  foreach(program mba_vo_node mba_vo_manager)
    add_executable(${program} tools/ros/${program}.cpp)
    mba_vo_ros_target(${program})
    target_link_libraries(${program} PRIVATE ${catkin_LIBRARIES})
    add_dependencies(${program} mba_vo_nodelets)
    set_property(GLOBAL APPEND PROPERTY MBA_VO_PROGRAMS ${program})
  endforeach()
endif()

add_executable(mba_vo_make_bag tools/ros/mba_vo_make_bag.cpp)
mba_vo_ros_target(mba_vo_make_bag)
target_link_libraries(mba_vo_make_bag PRIVATE mba_vo_ros mba_vo_datasets CLI11::CLI11)
set_property(GLOBAL APPEND PROPERTY MBA_VO_PROGRAMS mba_vo_make_bag)

add_executable(mba_vo_camera tools/ros/mba_vo_camera.cpp)
mba_vo_ros_target(mba_vo_camera)
target_link_libraries(mba_vo_camera PRIVATE mba_vo_ros CLI11::CLI11)
set_property(GLOBAL APPEND PROPERTY MBA_VO_PROGRAMS mba_vo_camera)

# The programs that also read or write bags when ROS is there; all programs are found by rosrun.
foreach(program mba_vo_calibrate mba_vo_check mba_vo_deblur_program mba_vo_export mba_vo_offline mba_vo_simulate)
  if(TARGET ${program})
    target_compile_definitions(${program} PRIVATE MBA_VO_WITH_ROS)
    mba_vo_ros_target(${program})
    target_link_libraries(${program} PRIVATE mba_vo_ros)
  endif()
endforeach()
get_property(programs GLOBAL PROPERTY MBA_VO_PROGRAMS)
set_target_properties(${programs} PROPERTIES
  RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})

if(MBA_VO_TESTS)
  include(cmake/MbaVoRosTests.cmake)
endif()
