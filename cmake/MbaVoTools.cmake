# The command-line programs that need no ROS: tools/<name>.cpp, with tools/<name>/*.cpp where there are any, becomes
# <name>. What several of them share is in tools/common.
file(GLOB MBA_VO_TOOLS_COMMON CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/tools/common/*.cpp)

function(mba_vo_tool name)
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/tools/${name}.cpp)
    set(target ${name})
    if(TARGET ${name})  # a module's library may have the same name
      set(target ${name}_program)
    endif()
    file(GLOB parts CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/tools/${name}/*.cpp)
    add_executable(${target} tools/${name}.cpp ${parts})
    target_include_directories(${target} PRIVATE tools/${name})
    set_target_properties(${target} PROPERTIES OUTPUT_NAME ${name})
    mba_vo_options(${target})
    target_link_libraries(${target} PRIVATE CLI11::CLI11 ${ARGN})
    set_property(GLOBAL APPEND PROPERTY MBA_VO_PROGRAMS ${target})
  endif()
endfunction()

mba_vo_tool(mba_vo_calibrate mba_vo_datasets)
mba_vo_tool(mba_vo_check mba_vo_inspection)
mba_vo_tool(mba_vo_deblur mba_vo_datasets)
mba_vo_tool(mba_vo_evaluate mba_vo_datasets)
mba_vo_tool(mba_vo_export mba_vo_datasets)
mba_vo_tool(mba_vo_map mba_vo_io)
mba_vo_tool(mba_vo_offline mba_vo_datasets)
mba_vo_tool(mba_vo_simulate mba_vo_simulation mba_vo_io)
foreach(program mba_vo_calibrate mba_vo_deblur_program mba_vo_export mba_vo_offline)  # that read any recording
  target_sources(${program} PRIVATE ${MBA_VO_TOOLS_COMMON})
  target_include_directories(${program} PRIVATE tools/common)
endforeach()

# In Python, with python3-yaml and, for pictures, python3-matplotlib.
if(MBA_VO_TESTS)
  add_test(NAME mba_vo_benchmark COMMAND /usr/bin/python3 -m unittest discover
           --start-directory ${CMAKE_CURRENT_SOURCE_DIR}/test/benchmark --pattern *_test.py)
  set_tests_properties(mba_vo_benchmark PROPERTIES TIMEOUT 300)
  # Short recordings in the forms of six data sets; with the programs, which are all in one folder.
  add_test(NAME data_sets COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/test/datasets/miniatures_test.py
           $<TARGET_FILE_DIR:mba_vo_offline>)
  set_tests_properties(data_sets PROPERTIES TIMEOUT 600)
  add_test(NAME mba_vo_docs COMMAND /usr/bin/python3 -B -m unittest discover
           --start-directory ${CMAKE_CURRENT_SOURCE_DIR}/test/docs --pattern *_test.py)
endif()

# A program called with these arguments must say what matches the regular expression.
function(mba_vo_tool_test name program expected)
  if(MBA_VO_TESTS AND TARGET ${program})
    add_test(NAME ${name} COMMAND ${program} ${ARGN})
    set_tests_properties(${name} PROPERTIES PASS_REGULAR_EXPRESSION "${expected}" TIMEOUT 120)
  endif()
endfunction()

mba_vo_tool_test(calibrate_without_sequence mba_vo_calibrate "SEQUENCE and --output are needed")
mba_vo_tool_test(calibrate_missing_sequence mba_vo_calibrate "/nonexistent: no such sequence" /nonexistent --output out)
mba_vo_tool_test(deblur_missing_sequence mba_vo_deblur_program "/nonexistent: no such sequence" /nonexistent --output out)
mba_vo_tool_test(deblur_without_sequence mba_vo_deblur_program "SEQUENCE and --output are needed")
mba_vo_tool_test(evaluate_missing_file mba_vo_evaluate "/nonexistent.txt: cannot be read"
  --groundtruth /nonexistent.txt --estimate /nonexistent.txt)
mba_vo_tool_test(evaluate_wrong_alignment mba_vo_evaluate "--alignment: Check affine"
  --groundtruth a --estimate b --alignment affine)
mba_vo_tool_test(export_without_output mba_vo_export "SEQUENCE and --output are needed" ${CMAKE_CURRENT_SOURCE_DIR})
mba_vo_tool_test(export_missing_sequence mba_vo_export "/nonexistent: no such sequence" /nonexistent --output out)
mba_vo_tool_test(export_wrong_form mba_vo_export "--form: kitti not in" x --output out --form kitti)
mba_vo_tool_test(export_row_time mba_vo_export "--row-time: none of the forms has a place for it" x --output out --row-time 3e-5)
mba_vo_tool_test(offline_without_sequence mba_vo_offline "SEQUENCE and --output are needed")
mba_vo_tool_test(offline_missing_sequence mba_vo_offline "/nonexistent: no such sequence" /nonexistent --output out)
mba_vo_tool_test(offline_missing_config mba_vo_offline "/nonexistent.yaml: cannot be read"
  --config /nonexistent.yaml --print-config)
mba_vo_tool_test(offline_wrong_exposure mba_vo_offline "exposure '-1': must be auto or 0 to 10 seconds"
  ${CMAKE_CURRENT_SOURCE_DIR} --output out --exposure=-1)
mba_vo_tool_test(offline_no_sequence_folder mba_vo_offline "no recording that is known: images and times.txt"
  ${CMAKE_CURRENT_SOURCE_DIR} --output out)
mba_vo_tool_test(offline_prints_config mba_vo_offline "max_points: [0-9]+  # patches aligned" --print-config)
mba_vo_tool_test(simulate_without_output mba_vo_simulate "--output or --bag is needed")
mba_vo_tool_test(simulate_wrong_rate mba_vo_simulate "--rate: Value 0 not in range" --output out --rate 0)
mba_vo_tool_test(simulate_long_exposure mba_vo_simulate "exposure = 0.05[0-9]* s is longer than the frame interval"
  --output out --exposure 0.05)
mba_vo_tool_test(simulate_wrong_lens mba_vo_simulate "distortion_model = 'barrel' is none of"
  --output out --distortion-model barrel)
mba_vo_tool_test(check_nothing_there mba_vo_check "/nonexistent: no such folder or bag" /nonexistent)
mba_vo_tool_test(check_topic_of_a_folder mba_vo_check "--image-topic /x: only bags have topics" ${CMAKE_CURRENT_SOURCE_DIR}
  --image-topic /x)
mba_vo_tool_test(check_images_of_a_bag mba_vo_check "--images x: only folders have such" ${CMAKE_CURRENT_SOURCE_DIR}/package.xml
  --images x)
mba_vo_tool_test(check_camera_of_a_bag mba_vo_check "--camera cam1: for a bag it chooses from --calibration"
  ${CMAKE_CURRENT_SOURCE_DIR}/package.xml --camera cam1)
