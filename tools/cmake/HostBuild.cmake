# Programs that a cross build runs on the host: this project's host build, in a folder of its own,
# unless STEADYSTEP_HOST_BUILD names one that has them. So does a sanitized build for what it runs none of.
include_guard(GLOBAL)

set(STEADYSTEP_HOST_BUILD "" CACHE PATH
  "Folder of the preset sil, built, that other builds take host programs from; empty: make one")

# host_build(<target> <variable> PROGRAMS <host target>... [BYPRODUCTS <path>...])
# <target>: builds the host targets. <variable>: receives the folder of the host build. BYPRODUCTS:
# files that the host targets make and rules of this build read, relative to that folder.
function(host_build target variable)
  cmake_parse_arguments(PARSE_ARGV 2 host "" "" "PROGRAMS;BYPRODUCTS")
  if(host_UNPARSED_ARGUMENTS OR NOT host_PROGRAMS)
    message(FATAL_ERROR
      "host_build(${target}): expected PROGRAMS and BYPRODUCTS, not '${host_UNPARSED_ARGUMENTS}'")
  endif()
  if(STEADYSTEP_HOST_BUILD)
    add_custom_target(${target})
    set(${variable} ${STEADYSTEP_HOST_BUILD} PARENT_SCOPE)
    return()
  endif()
  include(ExternalProject)
  set(folder ${PROJECT_BINARY_DIR}/host)
  list(TRANSFORM host_BYPRODUCTS PREPEND ${folder}/)
  set(options -DSTEADYSTEP_ALLOW_MISSING_MODULES=${STEADYSTEP_ALLOW_MISSING_MODULES})
  if(UNITY_DIR)
    list(APPEND options -DUNITY_DIR=${UNITY_DIR})
  endif()
  ExternalProject_Add(${target}
    SOURCE_DIR ${PROJECT_SOURCE_DIR}
    BINARY_DIR ${folder}
    CMAKE_ARGS -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_FLAGS_RELEASE=-O2 -DCMAKE_CXX_FLAGS_RELEASE=-O2
               ${options}
    BUILD_COMMAND ${CMAKE_COMMAND} --build ${folder} --target ${host_PROGRAMS}
    BUILD_ALWAYS ON
    BUILD_BYPRODUCTS ${host_BYPRODUCTS}
    INSTALL_COMMAND ""
    USES_TERMINAL_BUILD ON)
  set(${variable} ${folder} PARENT_SCOPE)
endfunction()
