# Checks of the STM32G071 image: register headers, and the image on the virtual board.
find_program(STEADYSTEP_HOST_CC NAMES cc gcc clang REQUIRED)
set(board_tests ${PROJECT_SOURCE_DIR}/tests/board)

add_test(NAME board.registers
  COMMAND ${Python3_EXECUTABLE} ${board_tests}/check_registers_g071.py
          ${STEADYSTEP_HOST_CC} ${PROJECT_SOURCE_DIR})
add_test(NAME board.registers-self-test
  COMMAND ${Python3_EXECUTABLE} ${board_tests}/check_registers_g071.py --self-test
          ${STEADYSTEP_HOST_CC} ${PROJECT_SOURCE_DIR})
add_test(NAME board.leg-voltage
  COMMAND ${Python3_EXECUTABLE} ${board_tests}/leg_voltage_g071.py
          ${STEADYSTEP_HOST_CC} ${PROJECT_SOURCE_DIR})
add_test(NAME board.stack
  COMMAND ${PROJECT_SOURCE_DIR}/tools/stack_bound $<TARGET_FILE:steadystep>)

# The virtual board runs on the host: the host build of this project, in a folder of its own, unless
# STEADYSTEP_HOST_BUILD names one that has it.
set(STEADYSTEP_HOST_BUILD "" CACHE PATH
  "Host build folder that holds stm32g071_runs; empty: make one")
if(STEADYSTEP_HOST_BUILD)
  set(host_build ${STEADYSTEP_HOST_BUILD})
else()
  include(ExternalProject)
  set(host_build ${PROJECT_BINARY_DIR}/host)
  ExternalProject_Add(host_virtual_board
    SOURCE_DIR ${PROJECT_SOURCE_DIR}
    BINARY_DIR ${host_build}
    CMAKE_ARGS -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_FLAGS_RELEASE=-O2 -DCMAKE_CXX_FLAGS_RELEASE=-O2
               -DSTEADYSTEP_ALLOW_MISSING_ROOMS=${STEADYSTEP_ALLOW_MISSING_ROOMS}
    BUILD_COMMAND ${CMAKE_COMMAND} --build ${host_build} --target stm32g071_runs
    BUILD_ALWAYS ON
    INSTALL_COMMAND ""
    USES_TERMINAL_BUILD ON)
endif()
add_test(NAME board.run
  COMMAND ${host_build}/tests/stm32g071_run $<TARGET_FILE:steadystep>)
add_test(NAME board.disturbances
  COMMAND ${host_build}/tests/stm32g071_disturbances $<TARGET_FILE:steadystep>)
set_tests_properties(
  board.registers board.registers-self-test board.leg-voltage board.stack board.run
  board.disturbances
  PROPERTIES LABELS board TIMEOUT 120)
