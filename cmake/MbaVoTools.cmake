# The command-line programs that need no ROS: tools/<name>.cpp becomes <name>.
function(mba_vo_tool name)
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/tools/${name}.cpp)
    add_executable(${name} tools/${name}.cpp)
    mba_vo_options(${name})
    target_link_libraries(${name} PRIVATE CLI11::CLI11 ${ARGN})
    set_property(GLOBAL APPEND PROPERTY MBA_VO_PROGRAMS ${name})
  endif()
endfunction()

mba_vo_tool(mba_vo_evaluate mba_vo_evaluation)
mba_vo_tool(mba_vo_offline mba_vo_io)
