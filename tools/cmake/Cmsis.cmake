# Target `cmsis_core`: CMSIS-Core(M) 5.4.0 (Arm, Apache-2.0), the registers and instructions of the
# core; fetched, never committed, and seen by the compiler as system headers.
#
# One upstream commit is pinned and each file is checked against its SHA-256, whatever its source:
#   1. what already lies in CMSIS_DIR
#   2. GitHub, at the pinned commit
#   3. the npm package @xpack-3rd-party/arm-cmsis-core 5.4.0-6, which holds the same files
include_guard(GLOBAL)
include(PinnedFiles)

set(cmsis_commit 13b9f72f212688d2306d0d085d87cbb4bf9e5d3f) # CMSIS 5.8.0
set(cmsis_package @xpack-3rd-party/arm-cmsis-core@5.4.0-6)
set(cmsis_sha256
  core_cm4.h       f5b63d52dd1557b15ca414cb59c264f595a7b5669db2a5878dffe22f4caedc8c
  core_cm0plus.h   a09fa9c6b8b21d1920bce15b98aa56182b027e9278cca0b154812bac2aea3cfa
  cmsis_version.h  0ad241efa3091a4a4dd9eb52a63611b4510e0a62d9b59ec439ff41c0d54bbb3a
  cmsis_compiler.h b51963d271c1571ca3463654c76aa7ea50c4eac5d0a2710df10414ac64d9e0f8
  cmsis_gcc.h      43bfd1fe69fbbc2ca70aaf7d43cc3e20f16e0c7f66e1bdef9b51af6dc14b2617
  mpu_armv7.h      29206b52ee02290ed6f5a5415ebd4187de802cf176d9b3cb844390d8e5571372)
set(CMSIS_DIR ${CMAKE_BINARY_DIR}/_deps/cmsis CACHE PATH "Folder with core_cm4.h and its like")

function(cmsis_from_npm)
  find_program(NPM npm)
  if(NOT NPM)
    message(STATUS "CMSIS-Core: npm is not installed")
    return()
  endif()
  set(scratch ${CMAKE_BINARY_DIR}/_deps/cmsis-package)
  file(MAKE_DIRECTORY ${scratch} ${CMSIS_DIR})
  execute_process(COMMAND ${NPM} pack --silent ${cmsis_package}
    WORKING_DIRECTORY ${scratch} OUTPUT_QUIET)
  file(GLOB archive ${scratch}/*.tgz)
  if(archive)
    file(ARCHIVE_EXTRACT INPUT ${archive} DESTINATION ${scratch})
    set(list ${cmsis_sha256})
    while(list)
      list(POP_FRONT list name expected)
      file(COPY ${scratch}/package/CMSIS/Core/Include/${name} DESTINATION ${CMSIS_DIR})
    endwhile()
  endif()
endfunction()

pinned_files_complete(have_cmsis ${CMSIS_DIR} "${cmsis_sha256}")
if(NOT have_cmsis)
  message(STATUS "CMSIS-Core: fetching from GitHub")
  pinned_files_download(
    https://raw.githubusercontent.com/ARM-software/CMSIS_5/${cmsis_commit}/CMSIS/Core/Include
    ${CMSIS_DIR} "${cmsis_sha256}")
  pinned_files_complete(have_cmsis ${CMSIS_DIR} "${cmsis_sha256}")
endif()
if(NOT have_cmsis)
  message(STATUS "CMSIS-Core: fetching the npm package ${cmsis_package}")
  cmsis_from_npm()
  pinned_files_complete(have_cmsis ${CMSIS_DIR} "${cmsis_sha256}")
endif()
if(NOT have_cmsis)
  message(FATAL_ERROR "CMSIS-Core: not obtained. Install npm, or put core_cm4.h, core_cm0plus.h, "
    "cmsis_version.h, cmsis_compiler.h, cmsis_gcc.h and mpu_armv7.h of CMSIS 5.8.0 into a folder "
    "and configure with -DCMSIS_DIR=<folder>.")
endif()

add_library(cmsis_core INTERFACE)
target_include_directories(cmsis_core SYSTEM INTERFACE ${CMSIS_DIR})
# Programs here have a start of their own; the default would declare that of the C library.
target_compile_definitions(cmsis_core INTERFACE __PROGRAM_START=reset_handler)
