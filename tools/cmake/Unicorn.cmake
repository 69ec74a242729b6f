# Target `unicorn`: the emulator of processors libunicorn (Unicorn Engine, GPL-2), fetched, never
# committed.
#
#   1. what already lies in UNICORN_DIR: include/unicorn/unicorn.h and lib/libunicorn.a
#   2. the wheel of PyPI, by its pinned hashes (unicorn-requirements.txt)
#   3. Debian's libunicorn-dev: 2.0.1, with which the virtual board takes twice the time
#
# 2.1.0 and 2.1.1 are the quick ones: in 2.0.1 and from 2.1.2 on every store asks the tables of
# translated code. 2.1.4 leaves out instructions that cross a page.
include_guard(GLOBAL)

set(UNICORN_DIR ${CMAKE_BINARY_DIR}/_deps/unicorn CACHE PATH "Folder with include and lib of Unicorn")

function(unicorn_from_pypi)
  set(scratch ${CMAKE_BINARY_DIR}/_deps/unicorn-package)
  file(MAKE_DIRECTORY ${scratch})
  execute_process(
    COMMAND python3 -m pip download --quiet --disable-pip-version-check --no-deps
            --only-binary :all: --require-hashes --dest ${scratch}
            --requirement ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/unicorn-requirements.txt
    ERROR_VARIABLE problem RESULT_VARIABLE failed)
  if(failed)
    message(STATUS "Unicorn: ${problem}")
    return()
  endif()
  file(GLOB wheel ${scratch}/*.whl)
  file(ARCHIVE_EXTRACT INPUT ${wheel} DESTINATION ${scratch}
    PATTERNS unicorn/include/* unicorn/lib/libunicorn.a)
  file(MAKE_DIRECTORY ${UNICORN_DIR})
  file(COPY ${scratch}/unicorn/include ${scratch}/unicorn/lib DESTINATION ${UNICORN_DIR})
  file(REMOVE_RECURSE ${scratch})
endfunction()

if(NOT EXISTS ${UNICORN_DIR}/lib/libunicorn.a)
  message(STATUS "Unicorn: fetching the wheel of PyPI")
  unicorn_from_pypi()
endif()

add_library(unicorn INTERFACE)
if(EXISTS ${UNICORN_DIR}/lib/libunicorn.a)
  find_package(Threads REQUIRED)
  target_include_directories(unicorn SYSTEM INTERFACE ${UNICORN_DIR}/include)
  target_link_libraries(unicorn INTERFACE ${UNICORN_DIR}/lib/libunicorn.a Threads::Threads m)
else()
  find_path(UNICORN_INCLUDE unicorn/unicorn.h)
  find_library(UNICORN_LIBRARY unicorn)
  if(NOT UNICORN_INCLUDE OR NOT UNICORN_LIBRARY)
    message(FATAL_ERROR "Unicorn: not obtained. Install libunicorn-dev, or unpack the wheel "
      "unicorn 2.1.1 and configure with -DUNICORN_DIR=<its folder unicorn>.")
  endif()
  message(STATUS "Unicorn: Debian's, slower")
  target_include_directories(unicorn SYSTEM INTERFACE ${UNICORN_INCLUDE})
  target_link_libraries(unicorn INTERFACE ${UNICORN_LIBRARY})
endif()
