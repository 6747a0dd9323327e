# Google Benchmark programs, and studies on recorded sequences (plain programs).
find_package(benchmark REQUIRED)

add_executable(tracking_benchmark bench/tracking_benchmark.cpp)
mba_vo_options(tracking_benchmark)
target_link_libraries(tracking_benchmark PRIVATE mba_vo_tracking mba_vo_simulation benchmark::benchmark)

add_executable(window_benchmark bench/window_benchmark.cpp)
mba_vo_options(window_benchmark)
target_link_libraries(window_benchmark PRIVATE mba_vo_window benchmark::benchmark)

add_executable(pose_graph_benchmark bench/pose_graph_benchmark.cpp)
mba_vo_options(pose_graph_benchmark)
target_link_libraries(pose_graph_benchmark PRIVATE mba_vo_pose_graph benchmark::benchmark)

add_executable(deblur_benchmark bench/deblur_benchmark.cpp)
mba_vo_options(deblur_benchmark)
target_link_libraries(deblur_benchmark PRIVATE mba_vo_deblur mba_vo_simulation benchmark::benchmark)

add_executable(initializer_study bench/initializer_study.cpp)
mba_vo_options(initializer_study)
target_link_libraries(initializer_study PRIVATE mba_vo_initialization opencv_imgcodecs)

file(GLOB tracking_study_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/bench/tracking_study/*.cpp)
add_executable(tracking_study ${tracking_study_sources})
mba_vo_options(tracking_study)
target_link_libraries(tracking_study PRIVATE mba_vo_tracking mba_vo_simulation)

file(GLOB honesty_study_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/bench/honesty_study/*.cpp)
add_executable(honesty_study ${honesty_study_sources})
mba_vo_options(honesty_study)
target_link_libraries(honesty_study PRIVATE mba_vo_io mba_vo_evaluation mba_vo_simulation opencv_imgcodecs)

add_executable(rotation_study bench/rotation_study.cpp)
mba_vo_options(rotation_study)
target_link_libraries(rotation_study PRIVATE mba_vo_odometry mba_vo_simulation mba_vo_evaluation)
