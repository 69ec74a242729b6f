# A module is a folder with a CMakeLists.txt. A missing one stops the configuration, so that no part
# of the project is left out unnoticed; -DSTEADYSTEP_ALLOW_MISSING_MODULES=ON turns that into a warning.
option(STEADYSTEP_ALLOW_MISSING_MODULES "Configure although modules of the project are missing" OFF)

function(missing_module what)
  if(STEADYSTEP_ALLOW_MISSING_MODULES)
    message(WARNING "missing: ${what}")
  else()
    message(FATAL_ERROR "missing: ${what}")
  endif()
endfunction()

macro(add_module folder)
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/CMakeLists.txt)
    add_subdirectory(${folder})
  else()
    missing_module("${CMAKE_CURRENT_SOURCE_DIR}/${folder}/CMakeLists.txt")
  endif()
endmacro()

# module_sources(<variable> <pattern>...): the files of a module, relative to the current folder. Every
# pattern must match something.
function(module_sources variable)
  set(all)
  foreach(pattern IN LISTS ARGN)
    file(GLOB found CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${pattern})
    if(NOT found)
      missing_module("${CMAKE_CURRENT_SOURCE_DIR}/${pattern}")
    endif()
    list(APPEND all ${found})
  endforeach()
  set(${variable} ${all} PARENT_SCOPE)
endfunction()

# precompile_headers(<target> <header>...): what most of its C++ sources include, and these, is read
# once: a third less time to compile. A source still includes what it uses: a cache of compilations
# does without, and with it each build behind a compiler launcher.
function(precompile_headers target)
  if(NOT CMAKE_CXX_COMPILER_LAUNCHER)
    target_precompile_headers(${target} PRIVATE <algorithm> <array> <cmath> <cstdint> <filesystem>
      <functional> <map> <memory> <optional> <stdexcept> <string> <vector> ${ARGN})
  endif()
endfunction()

# compile_together(<number> <target>...): so many sources of a target at a time, whose headers and
# templates are then read and instantiated once; again not behind a compiler launcher, for which a
# source is as much as changes.
function(compile_together number)
  if(NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set_target_properties(${ARGN} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${number})
  endif()
endfunction()
