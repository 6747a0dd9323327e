# What find_package(mba_vo) reads, in a build with ROS through catkin's own file, of which there can be but one: the
# libraries as targets mba_vo::geometry to mba_vo::io, with what they need.
include(CMakeFindDependencyMacro)
list(PREPEND CMAKE_MODULE_PATH ${mba_vo_DIR})  # FindCHOLMOD.cmake
find_dependency(Eigen3 3.3)
find_dependency(OpenCV COMPONENTS core imgproc imgcodecs calib3d video videoio dnn)
find_dependency(TBB)
find_dependency(yaml-cpp)
find_dependency(CHOLMOD)
find_dependency(ZLIB)
find_dependency(cereal)
list(REMOVE_AT CMAKE_MODULE_PATH 0)
if(NOT TARGET mba_vo::io)  # as in a workspace that catkin_make builds in one go
  include(${mba_vo_DIR}/mba_voTargets.cmake)
endif()
