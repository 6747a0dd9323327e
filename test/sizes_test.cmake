# No file is longer than can be read in one go, no room larger than can be kept in mind. Run as:
# cmake -DSOURCE_DIR=<repository> -P sizes_test.cmake
cmake_minimum_required(VERSION 3.16)
set(max_file 300)   # lines
set(max_room 4000)  # lines, headers count

function(count_lines file result)
  file(READ ${file} text)
  string(REGEX MATCHALL "\n" ends "${text}")
  list(LENGTH ends lines)
  set(${result} ${lines} PARENT_SCOPE)
endfunction()

set(too_long "")
file(GLOB_RECURSE files ${SOURCE_DIR}/bench/*.h ${SOURCE_DIR}/bench/*.cpp ${SOURCE_DIR}/cmake/*.cmake
     ${SOURCE_DIR}/examples/*.h ${SOURCE_DIR}/examples/*.cpp ${SOURCE_DIR}/scripts/*.sh ${SOURCE_DIR}/scripts/*.py
     ${SOURCE_DIR}/test/*.h ${SOURCE_DIR}/test/*.cpp ${SOURCE_DIR}/test/*.py ${SOURCE_DIR}/test/*.cmake
     ${SOURCE_DIR}/tools/*)
list(FILTER files EXCLUDE REGEX "\\.pyc$")
list(APPEND files ${SOURCE_DIR}/.ci/run ${SOURCE_DIR}/CMakeLists.txt)
file(GLOB rooms RELATIVE ${SOURCE_DIR}/src ${SOURCE_DIR}/src/*)
file(GLOB header_rooms RELATIVE ${SOURCE_DIR}/include/mba_vo ${SOURCE_DIR}/include/mba_vo/*)
list(APPEND rooms ${header_rooms})
list(REMOVE_DUPLICATES rooms)
foreach(room ${rooms})
  file(GLOB_RECURSE room_files ${SOURCE_DIR}/include/mba_vo/${room}/*.h ${SOURCE_DIR}/src/${room}/*.h
       ${SOURCE_DIR}/src/${room}/*.cpp)
  list(APPEND files ${room_files})
  set(sum 0)
  foreach(file ${room_files})
    count_lines(${file} lines)
    math(EXPR sum "${sum} + ${lines}")
  endforeach()
  if(sum GREATER max_room)
    list(APPEND too_long "room ${room}: ${sum} lines")
  endif()
endforeach()

list(LENGTH files checked)
if(checked LESS 100)
  message(FATAL_ERROR "only ${checked} files found below ${SOURCE_DIR}")
endif()
foreach(file ${files})
  count_lines(${file} lines)
  if(lines GREATER max_file)
    list(APPEND too_long "${file}: ${lines} lines")
  endif()
endforeach()
if(too_long)
  list(JOIN too_long "\n" text)
  message(FATAL_ERROR "More than ${max_file} lines in a file or ${max_room} in a room:\n${text}")
endif()
message(STATUS "${checked} files are short enough")
