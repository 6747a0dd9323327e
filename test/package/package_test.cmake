# Installs the build BUILD_DIR, moves what was installed, and uses it as a stranger would: configures, builds and runs
# EXAMPLE with it on a sequence that the installed simulator renders. With ROS, the moved folder is left in WORK_DIR/moved
# for the tests that start nodes from there. With SIMULATE, a simulator, only the library is installed.

include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

file(REMOVE_RECURSE ${WORK_DIR})
set(prefix ${WORK_DIR}/moved)
if(SIMULATE)
  set(component --component library)
endif()
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix ${component})
file(RENAME ${WORK_DIR}/prefix ${prefix})

if(NOT SIMULATE)
  # What launch files refer to.
  file(GLOB_RECURSE needed RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/config/* ${SOURCE_DIR}/launch/* ${SOURCE_DIR}/rviz/*)
  set(share ${prefix}/share/mba_vo)
  foreach(file ${needed})
    if(NOT EXISTS ${share}/${file} AND (EXISTS ${share}/launch OR file MATCHES "^config/"))  # no launch files without ROS
      message(FATAL_ERROR "${file} is not installed")
    endif()
  endforeach()
  file(GLOB_RECURSE SIMULATE ${prefix}/*/mba_vo_simulate)
endif()

# Nothing that is installed may lead back to where it was built.
file(GLOB_RECURSE exported ${prefix}/*mba_vo*.cmake)
if(NOT exported)
  message(FATAL_ERROR "no CMake file is installed")
endif()
foreach(file ${exported})
  file(STRINGS ${file} leading_back REGEX "${SOURCE_DIR}|${WORK_DIR}")
  if(leading_back)
    message(FATAL_ERROR "${file}: ${leading_back}")
  endif()
endforeach()

run(${SIMULATE} --output ${WORK_DIR}/sequence --width 320 --height 200 --fx 200 --rate 20 --duration 2 --exposure 0.01)
file(GLOB images ${WORK_DIR}/sequence/images/*)
run(${CMAKE_COMMAND} -S ${EXAMPLE} -B ${WORK_DIR}/build -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${CXX}
  -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_BUILD_TYPE=None
  -DPYTHON_EXECUTABLE=/usr/bin/python3 -DPython3_EXECUTABLE=/usr/bin/python3)  # catkin's, where ROS is part of it
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
run(${WORK_DIR}/build/minimal ${WORK_DIR}/sequence/camera.yaml 20 0.01 ${images})

string(REGEX MATCHALL "images/[0-9]+[^\n]*: from [^\n]+ to [^\n]+\n" poses "${output}")
list(LENGTH poses tracked)
list(LENGTH images all)
math(EXPR least "${all} / 2")
if(tracked LESS least)
  message(FATAL_ERROR "only ${tracked} of ${all} images have a pose:\n${output}")
endif()
message(STATUS "${tracked} of ${all} images have a pose")
