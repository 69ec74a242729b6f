# A board's image with other options, built by its test.
include_guard(GLOBAL)

# add_image_variant(<test> <folder> <number format> [OPTIONS <option>...] COMMAND <command>...)
# The image of this board builds in <folder> and the command holds. Takes the host's programs from the
# variable host_build.
function(add_image_variant test folder numeric)
  cmake_parse_arguments(PARSE_ARGV 3 variant "" "" "OPTIONS;COMMAND")
  if(variant_UNPARSED_ARGUMENTS OR NOT variant_COMMAND)
    message(FATAL_ERROR
      "add_image_variant(${test}): expected OPTIONS and COMMAND, not '${variant_UNPARSED_ARGUMENTS}'")
  endif()
  add_test(NAME board.${test} COMMAND ${CMAKE_CTEST_COMMAND}
    --build-and-test ${PROJECT_SOURCE_DIR} ${folder}
    --build-generator ${CMAKE_GENERATOR} --build-target steadystep
    --build-options -DSTEADYSTEP_CORE=${STEADYSTEP_CORE} -DSTEADYSTEP_BOARD=${STEADYSTEP_BOARD}
      -DCMAKE_TOOLCHAIN_FILE=${CMAKE_TOOLCHAIN_FILE} -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE}
      -DCMSIS_DIR=${CMSIS_DIR}
      "-DCMAKE_C_FLAGS_RELEASE=${CMAKE_C_FLAGS_RELEASE}" -DSTEADYSTEP_HOST_BUILD=${host_build}
      -DSTEADYSTEP_BOARD_NUMERIC=${numeric} ${variant_OPTIONS}
    --test-command ${variant_COMMAND})
  set_tests_properties(board.${test} PROPERTIES LABELS board TIMEOUT 300)
endfunction()
