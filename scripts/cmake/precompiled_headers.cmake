# Compiles what nearly every source includes once, instead of once a file: Eigen and the standard
# library take a third of the time that a compiler needs for a library's source, and with GoogleTest
# most of what it needs for a test.

# Sets RESULT to the targets of TYPE in FOLDER and below it.
function(_find_targets folder type result)
  set(found)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(target_type ${target} TYPE)
    if(target_type STREQUAL type)
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

# precompile_headers(NAME TYPE FOLDERS... [HEADERS headers...] [LINKS libraries...])
#
# Adds the library NAME, which compiles the headers that all have in common and HEADERS. The targets
# of TYPE in FOLDERS that link LINKS include them; but for those with options of their own, which a
# precompiled header would not fit.
function(precompile_headers name type)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "" "HEADERS;LINKS")
  add_library(${name} OBJECT ${PROJECT_SOURCE_DIR}/scripts/cmake/precompiled_headers.cc)
  target_link_libraries(${name} PRIVATE seapoint_flags Eigen3::Eigen ${arg_LINKS})
  target_precompile_headers(${name} PRIVATE ${arg_HEADERS} <Eigen/Core> <Eigen/Geometry> <algorithm>
    <cmath> <cstdint> <filesystem> <fstream> <functional> <map> <memory> <optional> <string> <vector>)
  get_property(own_options TARGET ${name} PROPERTY COMPILE_OPTIONS)
  foreach(folder IN LISTS arg_UNPARSED_ARGUMENTS)
    _find_targets(${PROJECT_SOURCE_DIR}/${folder} ${type} targets)
    foreach(target IN LISTS targets)
      get_property(options TARGET ${target} PROPERTY COMPILE_OPTIONS)
      get_property(linked TARGET ${target} PROPERTY LINK_LIBRARIES)
      set(missing ${arg_LINKS})
      list(REMOVE_ITEM missing ${linked})
      if("${options}" STREQUAL "${own_options}" AND NOT missing)
        target_precompile_headers(${target} REUSE_FROM ${name})
      endif()
    endforeach()
  endforeach()
endfunction()
