# Compiles what nearly every test includes once, instead of once a file. GoogleTest and Eigen take
# most of the time that a compiler needs for a test.
function(precompile_test_headers)  # TARGET...
  add_library(test_headers OBJECT ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/precompiled_headers.cc)
  target_link_libraries(test_headers PRIVATE seapoint_flags Eigen3::Eigen GTest::gtest)
  target_precompile_headers(test_headers PRIVATE
    <gtest/gtest.h> <Eigen/Core> <Eigen/Geometry>
    <algorithm> <cmath> <filesystem> <fstream> <functional> <map> <random> <set> <string> <vector>)
  foreach(target IN LISTS ARGN)
    target_precompile_headers(${target} REUSE_FROM test_headers)
  endforeach()
endfunction()
