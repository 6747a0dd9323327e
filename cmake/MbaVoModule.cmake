# Every module is a static library mba_vo_<name> made of src/<name>/*.cpp, with one test program mba_vo_<name>_test made of
# test/<name>/*_test.cpp. What only the tests link to (TEST_DEPENDS) does not count as a dependency of the module.

set(MBA_VO_WARNINGS -Wall -Wextra -Wshadow -Wconversion -Werror)

function(mba_vo_options target)
  target_compile_options(${target} PRIVATE ${MBA_VO_WARNINGS})
  if(CMAKE_UNITY_BUILD)  # a room as one translation unit, whose files may use one name for a local and for a constant
    target_compile_options(${target} PRIVATE -Wno-shadow)
  endif()
  if(target MATCHES "_test$")  # most of it runs once: what compiles sooner is done sooner
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  get_target_property(type ${target} TYPE)
  if(MBA_VO_LINT OR target MATCHES "^mba_vo_precompiled")
  elseif(target MATCHES "_test$")
    target_precompile_headers(${target} REUSE_FROM mba_vo_precompiled_test)
  elseif(type STREQUAL EXECUTABLE)
    target_precompile_headers(${target} REUSE_FROM mba_vo_precompiled_program)
  else()
    target_precompile_headers(${target} REUSE_FROM mba_vo_precompiled_library)
  endif()
  if(MBA_VO_VECTORS)
    target_compile_definitions(${target} PRIVATE MBA_VO_VECTORS_${MBA_VO_VECTORS})
  endif()
  if(MBA_VO_SANITIZE)
    # Checks of every pointer double the compile time; the address sanitizer finds what they find. GCC takes values for
    # uninitialised that are not, where it is told to sanitize.
    target_compile_options(${target} PRIVATE -fsanitize=${MBA_VO_SANITIZE} -fno-omit-frame-pointer -g1
                           -fno-sanitize=null,alignment,pointer-overflow,object-size,vptr -Wno-maybe-uninitialized)
    target_link_options(${target} PUBLIC -fsanitize=${MBA_VO_SANITIZE})
    target_compile_definitions(${target} PRIVATE MBA_VO_SANITIZED)
  endif()
endfunction()

# Libraries and programs are compiled with different options, hence a set of headers for each; tests have Google Test
# besides. Lint goes without them, and tells where an include is missing.
if(NOT MBA_VO_LINT)
  set(mba_vo_precompiled_source ${CMAKE_CURRENT_BINARY_DIR}/precompiled.cpp)
  if(NOT EXISTS ${mba_vo_precompiled_source})
    file(WRITE ${mba_vo_precompiled_source} "int main() { return 0; }\n")
  endif()
  add_library(mba_vo_precompiled_library STATIC ${mba_vo_precompiled_source})
  set(mba_vo_precompiled mba_vo_precompiled_library mba_vo_precompiled_program)
  add_executable(mba_vo_precompiled_program ${mba_vo_precompiled_source})
  if(MBA_VO_TESTS)
    list(APPEND mba_vo_precompiled mba_vo_precompiled_test)
    add_executable(mba_vo_precompiled_test ${mba_vo_precompiled_source})
    target_link_libraries(mba_vo_precompiled_test PRIVATE GTest::gtest)
    target_precompile_headers(mba_vo_precompiled_test PRIVATE <gtest/gtest.h> <opencv2/imgproc.hpp>)
  endif()
  foreach(target ${mba_vo_precompiled})
    mba_vo_options(${target})
    target_include_directories(${target} SYSTEM PRIVATE ${OpenCV_INCLUDE_DIRS})
    target_link_libraries(${target} PRIVATE Eigen3::Eigen)
    target_precompile_headers(${target} PRIVATE <Eigen/Core> <Eigen/Geometry> <Eigen/Cholesky> <opencv2/core.hpp>
      <algorithm> <array> <cmath> <cstdint> <functional> <map> <memory> <optional> <string> <utility> <vector>)
  endforeach()
endif()

# Several files are compiled at a time, with short names in them: each is in a namespace of its own, called as the file.
function(mba_vo_test target)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;DEPENDS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 1200)
  endif()
  add_executable(${target} ${ARG_SOURCES})
  mba_vo_options(${target})
  # GCC 12 warns falsely about inlined Eigen vectors of one element.
  target_compile_options(${target} PRIVATE -Wno-array-bounds)
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/test)
  target_link_libraries(${target} PRIVATE ${ARG_DEPENDS} GTest::gmock GTest::gtest GTest::gtest_main)
  target_compile_definitions(${target} PRIVATE MBA_VO_SOURCE_DIR="${CMAKE_CURRENT_SOURCE_DIR}")
  if(MBA_VO_SANITIZE)  # what tests share, rendered rooms above all, is made but once
    add_test(NAME ${target} COMMAND ${target})
    set_tests_properties(${target} PROPERTIES TIMEOUT ${ARG_TIMEOUT})
  else()
    # An entry for each test, so that its time shows: mba_vo_odometry_test/InputGuard.StampsMustIncrease.
    gtest_discover_tests(${target} TEST_PREFIX ${target}/ DISCOVERY_TIMEOUT 120 PROPERTIES TIMEOUT ${ARG_TIMEOUT})
  endif()
endfunction()

function(mba_vo_module name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;TEST_DEPENDS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/${name}/*.cpp)
  set(target mba_vo_${name})
  if(sources)
    add_library(${target} STATIC ${sources})
    mba_vo_options(${target})
    set(visibility PUBLIC)
    target_include_directories(${target} SYSTEM PUBLIC "$<BUILD_INTERFACE:${OpenCV_INCLUDE_DIRS}>")
  else()
    add_library(${target} INTERFACE)
    set(visibility INTERFACE)
  endif()
  target_include_directories(${target} ${visibility}
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
  target_link_libraries(${target} ${visibility} ${ARG_DEPENDS})
  target_compile_features(${target} ${visibility} cxx_std_17)
  # To those who use the package, or have it as a subdirectory: mba_vo::<name>.
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  add_library(${PROJECT_NAME}::${name} ALIAS ${target})
  set_property(GLOBAL APPEND PROPERTY MBA_VO_MODULES ${target})
  file(GLOB tests CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/test/${name}/*_test.cpp)
  if(MBA_VO_TESTS AND tests)
    mba_vo_test(${target}_test SOURCES ${tests} DEPENDS ${target} ${ARG_TEST_DEPENDS})
  endif()
endfunction()
