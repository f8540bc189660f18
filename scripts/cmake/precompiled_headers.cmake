# Compiles what nearly every source includes once, instead of once a file: Eigen and the standard
# library take a third of the time that a compiler needs for a library's source, and with GoogleTest
# most of what it needs for a test.

# Sets RESULT to the targets in FOLDER and below it that are of TYPE, are compiled with our flags, and
# have none of their own, with which a precompiled header would not fit.
function(_find_targets folder type result)
  set(found)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(target_type ${target} TYPE)
    get_target_property(options ${target} COMPILE_OPTIONS)
    if(target_type STREQUAL type AND NOT options)
      list(APPEND found ${target})
    endif()
  endforeach()
  get_property(folders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(sub_folder IN LISTS folders)
    _find_targets(${sub_folder} ${type} more)
    list(APPEND found ${more})
  endforeach()
  set(${result} ${found} PARENT_SCOPE)
endfunction()

# Adds the library NAME, which compiles the headers, and lets the targets include them.
function(_precompile name targets headers)
  add_library(${name} OBJECT ${PROJECT_SOURCE_DIR}/scripts/cmake/precompiled_headers.cc)
  target_link_libraries(${name} PRIVATE seapoint_flags Eigen3::Eigen ${ARGN})
  target_precompile_headers(${name} PRIVATE ${headers})
  foreach(target IN LISTS targets)
    target_precompile_headers(${target} REUSE_FROM ${name})
  endforeach()
endfunction()

# For all libraries and test programs that are known when it is called.
function(precompile_headers)
  set(headers <Eigen/Core> <Eigen/Geometry> <algorithm> <cmath> <cstdint> <filesystem> <fstream>
    <functional> <map> <memory> <optional> <string> <vector>)
  set(libraries)
  foreach(folder IN ITEMS colmap_seapoint feature densify examples)
    _find_targets(${PROJECT_SOURCE_DIR}/${folder} STATIC_LIBRARY more)
    list(APPEND libraries ${more})
  endforeach()
  _precompile(library_headers "${libraries}" "${headers}")
  if(SEAPOINT_TESTS)
    find_package(GTest REQUIRED)
    set(tests)
    _find_targets(${PROJECT_SOURCE_DIR}/tests EXECUTABLE programs)
    foreach(program IN LISTS programs)
      get_target_property(linked ${program} LINK_LIBRARIES)
      if("GTest::gtest" IN_LIST linked)
        list(APPEND tests ${program})
      endif()
    endforeach()
    _precompile(test_headers "${tests}" "<gtest/gtest.h>;<random>;<set>;${headers}" GTest::gtest)
  endif()
endfunction()
