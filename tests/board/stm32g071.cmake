# Checks of the STM32G071 image: register headers, and the image on the virtual board.
include(HostBuild)
include(ImageVariant)
find_program(STEADYSTEP_HOST_CC NAMES cc gcc clang REQUIRED)
set(board_tests ${PROJECT_SOURCE_DIR}/tests/board)

set(registers ${STEADYSTEP_HOST_CC} ${PROJECT_SOURCE_DIR} ${CMSIS_DIR} ${pin_map})
add_test(NAME board.registers
  COMMAND ${Python3_EXECUTABLE} ${board_tests}/check_registers_g071.py ${registers})
add_test(NAME board.registers-self-test
  COMMAND ${Python3_EXECUTABLE} ${board_tests}/check_registers_g071.py --self-test ${registers})
add_test(NAME board.leg-voltage
  COMMAND ${Python3_EXECUTABLE} ${board_tests}/leg_voltage_g071.py
          ${STEADYSTEP_HOST_CC} ${PROJECT_SOURCE_DIR})
add_test(NAME board.flash-targets
  COMMAND ${board_tests}/flash_targets.py ${PROJECT_BINARY_DIR})
add_test(NAME board.stack
  COMMAND ${PROJECT_SOURCE_DIR}/tools/stack_bound $<TARGET_FILE:steadystep>)

# The virtual board has the wiring of the reference map.
if(NOT STEADYSTEP_PIN_MAP STREQUAL default_pin_map)
  message(STATUS "Pin map ${STEADYSTEP_PIN_MAP}: the image is not run on the virtual board")
  return()
endif()

# What follows executes the image, on the host.
host_build(host_virtual_board host_build PROGRAMS stm32g071_run stm32g071_disturbances)
add_test(NAME board.run
  COMMAND ${host_build}/tests/stm32g071_run $<TARGET_FILE:steadystep>)
# The image for one motor, whose interrupt is shorter.
set(one_motor ${PROJECT_BINARY_DIR}/one-motor)
add_image_variant(one-motor ${one_motor} one_motor
  COMMAND ${host_build}/tests/stm32g071_run ${one_motor}/steadystep.elf)
set_tests_properties(board.one-motor PROPERTIES LABELS full)
add_test(NAME board.disturbances
  COMMAND ${host_build}/tests/stm32g071_disturbances $<TARGET_FILE:steadystep>)
set_tests_properties(
  board.registers board.registers-self-test board.leg-voltage board.flash-targets
  board.stack board.run
  board.disturbances
  PROPERTIES LABELS board TIMEOUT 120)
