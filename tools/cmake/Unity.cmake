# Target `unity`: the unit-test framework Unity (ThrowTheSwitch, MIT), fetched, never committed.
#
# One upstream commit is pinned and each file is checked against its SHA-256, whatever its source:
#   1. what already lies in UNITY_DIR
#   2. GitHub, at the pinned commit
#   3. the Debian source package ntpsec 1.2.2, whose tests/unity is byte-identical to that commit
include_guard(GLOBAL)
include(PinnedFiles)

set(unity_commit c3afe99a77b3ccd865f2768b18c038ec9600b56a) # 2.5.1 and 20 commits
set(unity_sha256
  unity.c           2e3a0610268455520a5796345b503d00c34a47fe97ed3750349cbd4b2b1990f3
  unity.h           681ac98a63ac11effb11e59d580f6ca82abca1bd34069465c38e3b15344256c0
  unity_internals.h adfd612c217e59468c5ebe978640e77e5f539e820ffc0c195a98c5a36f0ac868)
set(UNITY_DIR ${CMAKE_BINARY_DIR}/_deps/unity CACHE PATH
  "Folder with unity.c, unity.h and unity_internals.h")

function(unity_from_debian)
  execute_process(COMMAND sh ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/unity_from_debian.sh ${UNITY_DIR})
endfunction()

pinned_files_complete(have_unity ${UNITY_DIR} "${unity_sha256}")
if(NOT have_unity)
  message(STATUS "Unity: fetching from GitHub")
  pinned_files_download(
    https://raw.githubusercontent.com/ThrowTheSwitch/Unity/${unity_commit}/src
    ${UNITY_DIR} "${unity_sha256}")
  pinned_files_complete(have_unity ${UNITY_DIR} "${unity_sha256}")
endif()
if(NOT have_unity)
  message(STATUS "Unity: fetching from the Debian source package ntpsec")
  unity_from_debian()
  pinned_files_complete(have_unity ${UNITY_DIR} "${unity_sha256}")
endif()
if(NOT have_unity)
  message(FATAL_ERROR "Unity: not obtained. Put unity.c, unity.h and unity_internals.h of commit "
    "${unity_commit} into a folder and configure with -DUNITY_DIR=<folder>.")
endif()

add_library(unity STATIC ${UNITY_DIR}/unity.c)
target_include_directories(unity SYSTEM PUBLIC ${UNITY_DIR})
target_compile_definitions(unity PUBLIC UNITY_INCLUDE_DOUBLE UNITY_SUPPORT_64)
target_compile_options(unity
  PRIVATE -w
  INTERFACE "$<$<COMPILE_LANGUAGE:CXX>:SHELL:-include ${CMAKE_CURRENT_LIST_DIR}/unity_cxx.h>")
