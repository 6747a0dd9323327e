# Google Benchmark programs.

# Studies on recorded sequences: plain programs.
add_executable(initializer_study bench/initializer_study.cpp)
mba_vo_options(initializer_study)
target_link_libraries(initializer_study PRIVATE mba_vo_mapping opencv_imgcodecs)
