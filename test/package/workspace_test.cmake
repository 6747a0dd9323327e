# A catkin workspace with this package and one that depends on it, built and installed by catkin_make, used through the setup.bash
# of either space. Objects of the package's own sources are those of BUILD_DIR, which compiled the same files with the
# same options: what is tried is all else, that is configuration, messages, linking, both spaces, and what ROS finds there.

include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

# Makes the workspace as one who cloned the repository into it.
function(make_workspace)
  file(REMOVE_RECURSE ${WORK_DIR})
  file(GLOB entries RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/*)
  list(FILTER entries EXCLUDE REGEX "^(build|devel|output|install|[.])")
  list(TRANSFORM entries PREPEND ${SOURCE_DIR}/)
  file(COPY ${entries} DESTINATION ${WORK_DIR}/src/mba_vo)
  file(COPY ${SOURCE_DIR}/test/package/dependent DESTINATION ${WORK_DIR}/src)
endfunction()

# Runs a command line in a shell that has sourced the setup.bash of `space`, devel or install, and nothing else.
function(run_in space command)
  run(env -u ROS_PACKAGE_PATH -u PYTHONPATH -u LD_LIBRARY_PATH CMAKE_PREFIX_PATH= PKG_CONFIG_PATH=
    bash -c "source '${WORK_DIR}/${space}/setup.bash' && ${command}")
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(expect_in_output text what)
  string(FIND "${output}" "${text}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "${what}: '${text}' is not in\n${output}")
  endif()
endfunction()

# What a user types: each must be found in this space, and not in another.
function(use space package)
  run_in(${space} "rospack find mba_vo")
  expect_in_output(${package} "rospack find in ${space}")
  run_in(${space} "catkin_find --first-only --without-underlays --libexec mba_vo")
  expect_in_output(${WORK_DIR}/${space}/ "catkin_find in ${space}")
  run_in(${space} "rosrun mba_vo mba_vo_simulate --output ${WORK_DIR}/sequence --overwrite --width 128 --height 96 --fx 100 --duration 0.2")
  run_in(${space} "rosrun mba_vo mba_vo_make_bag ${WORK_DIR}/sequence --output ${WORK_DIR}/made.bag")
  run_in(${space} "rosrun mba_vo exposure_relay --help")
  expect_in_output(realsense "exposure_relay in ${space}")
  run_in(${space} "rosmsg show mba_vo/ExposureStamped")
  expect_in_output(exposure_time "rosmsg in ${space}")
  run_in(${space} "roslaunch mba_vo mba_vo.launch --files && roslaunch mba_vo webcam.launch --nodes")
  expect_in_output(${package}/launch/mba_vo.launch "roslaunch in ${space}")
  expect_in_output(/mba_vo/tracking "roslaunch in ${space}")
  run_in(${space} "rospack plugins --attrib=plugin nodelet")
  expect_in_output("mba_vo ${package}/nodelet_plugins.xml" "plugins in ${space}")
  if(NOT EXISTS ${package}/nodelet_plugins.xml)  # rospack does not mind
    message(FATAL_ERROR "${package}/nodelet_plugins.xml does not exist")
  endif()
  run_in(${space} "rosrun mba_vo_dependent dependent ${WORK_DIR}/sequence/camera.yaml")
  expect_in_output("mba_vo/ExposureMotion, 128x96, 100 px" "the dependent package in ${space}")
endfunction()

# Nodes and nodelets of it, with a master.
function(start space)
  run_in(${space} "rostest ${SOURCE_DIR}/test/ros/rostest/install_space.test")
  foreach(failure "has died" "Failed to load")  # then all is shut down, and publishtest does not mind
    string(FIND "${output}" "${failure}" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "started from ${space}:\n${output}")
    endif()
  endforeach()
endfunction()

make_workspace()
run(${CATKIN_MAKE} -C ${WORK_DIR} install -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DMBA_VO_TESTS=OFF -DCMAKE_UNITY_BUILD=${UNITY} -DPYTHON_EXECUTABLE=/usr/bin/python3
  "-DCMAKE_CXX_COMPILER_LAUNCHER=${SOURCE_DIR}/test/package/reuse_object.sh$<SEMICOLON>${BUILD_DIR}")
use(devel ${WORK_DIR}/src/mba_vo)
start(devel)
use(install ${WORK_DIR}/install/share/mba_vo)
