# Programs for the ARM core, run by ctest under CMAKE_CROSSCOMPILING_EMULATOR.
include(FirmwareObject)
include(HostBuild)
include(Unity)
set(CMAKE_EXECUTABLE_SUFFIX .elf)

add_library(target_startup OBJECT startup.c)
target_link_options(target_startup INTERFACE -T ${CMAKE_CURRENT_SOURCE_DIR}/qemu.ld)
if(STEADYSTEP_CORE STREQUAL m4f) # without optimisation the float image is larger than the other's flash
  target_link_options(target_startup INTERFACE -Wl,--defsym=flash_bytes=4194304)
endif()
set_target_properties(target_startup PROPERTIES
  INTERFACE_LINK_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/qemu.ld)

set(recorders ${STEADYSTEP_NUMERICS})
list(TRANSFORM recorders PREPEND tests/target/record_input_)
host_build(host_recorder host_build PROGRAMS record_input BYPRODUCTS ${recorders})

# Of the format that the core's board is flashed with the replays, which run the code of all laws; of
# the others, which are the same source, they are there to be asked for by name (tools/cycles,
# tools/determinism). Of the unit tests tools/test runs those of the arithmetic, which knows the core;
# all else is left to --full.
if(STEADYSTEP_CORE STREQUAL m4f)
  set(flashed float)
else()
  set(flashed fixed)
endif()
set(arithmetic angle num num_armv6m park trig)
module_sources(arithmetic_sources ../../firmware/numeric/*.c ../../firmware/design/elementary.c)

foreach(numeric IN LISTS STEADYSTEP_NUMERICS)
  set(variant OFF)
  if(NOT STEADYSTEP_FULL_TESTS AND NOT numeric STREQUAL flashed)
    set(variant ON)
    number_format(${numeric} definitions)
    add_library(arithmetic_${numeric} STATIC EXCLUDE_FROM_ALL ${arithmetic_sources})
    target_compile_definitions(arithmetic_${numeric} PUBLIC ${definitions})
    set_target_properties(firmware_${numeric} PROPERTIES EXCLUDE_FROM_ALL ON)
  endif()
  add_library(firmware_image_${numeric} OBJECT EXCLUDE_FROM_ALL ${PROJECT_SOURCE_DIR}/hal/sil/firmware_image.c)
  target_link_libraries(firmware_image_${numeric} PUBLIC firmware_${numeric})
  target_compile_definitions(firmware_image_${numeric} PRIVATE FIRMWARE_IMAGE_NUMERIC=${numeric}
    STEADYSTEP_WITHOUT_LINK) # a replay has no bus, and no memory for one
  set(firmware ${CMAKE_CURRENT_BINARY_DIR}/firmware_${numeric}.o)
  firmware_object(${firmware} $<TARGET_OBJECTS:firmware_image_${numeric}>
                              $<TARGET_OBJECTS:firmware_${numeric}>)

  file(GLOB unit_tests CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/../unit/test_*.c)
  # Their reference is minutes of double in software; on the core the replays `feedback-linearisation`
  # and `references` run the same code.
  list(FILTER unit_tests EXCLUDE REGEX "test_(detent_compensation|motion_plan)\\.c$")
  # Closed loops, too, whose motor is doubles, and designs, of which each takes a second.
  list(FILTER unit_tests EXCLUDE REGEX
    "test_(capture|drive_laws|drive_faults|drive_standstill|designed_anew|hold_bearing|law_gains|version_gains|version_run)\\.c$")
  # Likewise; moreover this core has no board with an encoder.
  if(STEADYSTEP_CORE STREQUAL m0plus)
    list(FILTER unit_tests EXCLUDE REGEX "test_encoder_alignment\\.c$")
  endif()
  # Their courses take more memory, or time, than a core here has.
  list(FILTER unit_tests EXCLUDE REGEX "test_(motion_delay|headroom)\\.c$")
  # An application, its test's board and the stack of the design take more than 16 KB.
  set(large_tests application axis axis_homing axis_motion axis_stream axis_torque can_bus canopen cia402 console machine_io modbus node parts_left_out pdo resets sdo
    setting_lines settings_in_motion settings_record torque_constant)
  # In fixed point each test runs on one core: the M4F has the long ones, the M0+ all others.
  # Arithmetic, which knows the core, runs on both. The long ones in fixed point are left to
  # tools/test --full: in float they run, and the replays run their code.
  set(long_tests "application|axis|axis_homing|axis_motion|axis_stream|axis_torque|can_bus|canopen|cia402|console|machine_io|modbus|node|parts_left_out|pdo|resets|sdo|setting_lines|settings_in_motion|settings_record|torque_constant|initial_position|invariant_ekf|motion|sliding_mode")
  if(STEADYSTEP_CORE STREQUAL m0plus)
    list(FILTER unit_tests EXCLUDE REGEX "test_(${long_tests})\\.c$")
  elseif(numeric STREQUAL fixed)
    list(FILTER unit_tests INCLUDE REGEX "test_(${long_tests}|num|num_armv6m|trig|park)\\.c$")
  endif()
  if(numeric STREQUAL one_motor) # the same source as fixed
    list(FILTER unit_tests INCLUDE REGEX "test_coefficients\\.c$")
  endif()
  foreach(source IN LISTS unit_tests)
    cmake_path(GET source STEM stem)
    string(REGEX REPLACE "^test_" "" name ${stem})
    set(target unit_${name}_${numeric})
    add_executable(${target} ${source})
    set(firmware_of_test firmware_${numeric})
    if(variant AND name IN_LIST arithmetic)
      set(firmware_of_test arithmetic_${numeric})
    endif()
    target_link_libraries(${target} PRIVATE target_startup ${firmware_of_test} unity m)
    if(name IN_LIST large_tests)
      target_link_options(${target} PRIVATE -Wl,--defsym=ram_bytes=65536)
    endif()
    # Of objects as compiled; the replays below link the firmware optimised as a whole. The tests
    # themselves are compiled quickly, but for arithmetic, which stands in headers.
    target_compile_options(${target} PRIVATE -fno-lto)
    if(NOT name IN_LIST arithmetic)
      target_compile_options(${target} PRIVATE -O1)
    endif()
    target_link_options(${target} PRIVATE -fno-lto)
    add_test(NAME target.unit.${name}.${numeric} COMMAND ${target})
    set(labels target)
    set(timeout_s 120)
    if(NOT name IN_LIST arithmetic) # some are closed loops, ten seconds to minutes under QEMU
      list(APPEND labels full)
      set(timeout_s 600)
      if(NOT STEADYSTEP_FULL_TESTS)
        set_target_properties(${target} PROPERTIES EXCLUDE_FROM_ALL ON)
      endif()
    endif()
    set_tests_properties(target.unit.${name}.${numeric}
      PROPERTIES LABELS "${labels}" TIMEOUT ${timeout_s})
  endforeach()

  replay_cases_of(${numeric} cases)
  foreach(case IN LISTS cases)
    add_replay(${case} ${numeric} ${host_build}/tests/target/record_input_${numeric})
    set(target replay_${case}_${numeric})
    add_dependencies(${target} host_recorder)
    target_sources(${target} PRIVATE ${firmware})
    target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
    target_link_libraries(${target} PRIVATE target_startup)
    target_link_options(${target} PRIVATE -fno-lto -Wl,-Map=$<TARGET_FILE:${target}>.map)
    add_test(NAME target.replay.${case}.${numeric} COMMAND ${target})
    set(labels target)
    if(NOT numeric STREQUAL flashed)
      list(APPEND labels full)
    endif()
    if(variant)
      set_target_properties(${target} PROPERTIES EXCLUDE_FROM_ALL ON)
    endif()
    set_tests_properties(target.replay.${case}.${numeric} PROPERTIES LABELS "${labels}" TIMEOUT 120)
  endforeach()

  # One case of each path through the interrupt, and one that no case leaves anything out of.
  set(longest default-sensorless feedback-linearisation references)
  if(numeric STREQUAL one_motor)
    set(longest)
  endif()
  foreach(case IN LISTS longest)
    add_test(NAME target.longest-path.${case}.${numeric}
      COMMAND ${PROJECT_SOURCE_DIR}/tools/longest_path --executed
              $<TARGET_FILE:replay_${case}_${numeric}>)
    set(labels target)
    if(NOT (case STREQUAL references # which leaves nothing out
            AND STEADYSTEP_CORE STREQUAL "m4f" AND numeric STREQUAL float))
      list(APPEND labels full)
    endif()
    set_tests_properties(target.longest-path.${case}.${numeric}
      PROPERTIES LABELS "${labels}" TIMEOUT 120)
  endforeach()

  add_test(NAME target.interrupt-is-clean.${numeric}
    COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/interrupt_is_clean.py
            $<TARGET_FILE:replay_default-sensorless_${numeric}> ${STEADYSTEP_BACKGROUND})
  set(labels target)
  if(NOT numeric STREQUAL flashed)
    list(APPEND labels full)
  endif()
  set_tests_properties(target.interrupt-is-clean.${numeric} PROPERTIES LABELS "${labels}")
endforeach()

separate_arguments(core_flags UNIX_COMMAND "${CMAKE_C_FLAGS}")
add_test(NAME target.interrupt-is-clean.self-test
  COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/interrupt_is_clean.py
          --self-test ${CMAKE_C_COMPILER} ${core_flags})
set_tests_properties(target.interrupt-is-clean.self-test PROPERTIES LABELS target)
add_test(NAME target.arm-image-is-read-right
  COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/arm_image_is_read_right.py ${CMAKE_C_COMPILER} ${core_flags})
set_tests_properties(target.arm-image-is-read-right PROPERTIES LABELS target)
