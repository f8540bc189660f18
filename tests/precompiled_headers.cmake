# Compiles what nearly every test includes once, instead of once a file: GoogleTest and Eigen take
# most of the time that a compiler needs for a test.

# Sets RESULT to the programs below FOLDER that link GoogleTest.
function(_find_test_programs folder result)
  set(programs)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(libraries ${target} LINK_LIBRARIES)
    if("GTest::gtest" IN_LIST libraries)
      list(APPEND programs ${target})
    endif()
  endforeach()
  get_property(folders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(sub_folder IN LISTS folders)
    _find_test_programs(${sub_folder} more)
    list(APPEND programs ${more})
  endforeach()
  set(${result} ${programs} PARENT_SCOPE)
endfunction()

# For all test programs below this folder that are known when it is called.
function(precompile_test_headers)
  _find_test_programs(${CMAKE_CURRENT_SOURCE_DIR} programs)
  add_library(test_headers OBJECT ${CMAKE_CURRENT_SOURCE_DIR}/precompiled_headers.cc)
  target_link_libraries(test_headers PRIVATE seapoint_flags Eigen3::Eigen GTest::gtest)
  target_precompile_headers(test_headers PRIVATE
    <gtest/gtest.h> <Eigen/Core> <Eigen/Geometry>
    <algorithm> <cmath> <filesystem> <fstream> <functional> <map> <random> <set> <string> <vector>)
  foreach(program IN LISTS programs)
    target_precompile_headers(${program} REUSE_FROM test_headers)
  endforeach()
endfunction()
