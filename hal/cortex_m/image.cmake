# What the ports to Cortex-M cores have in common: pin map, CMSIS-Core, version and default motor of
# an image, and what is made of it. A port's CMakeLists.txt includes this file.
set(STEADYSTEP_MOTOR bendjedia-2012 CACHE STRING
  "Default motor: a file of sil/motors, without .toml, or the path of one of your own")
set(STEADYSTEP_PIN_MAP ${default_pin_map} CACHE STRING
  "Pin map: a file of the port's pin_maps/, without .h, or the path of one of your own")
set(STEADYSTEP_CONTROL_kHz 10 CACHE STRING "Control periods per millisecond; of PWM, too")
if(NOT STEADYSTEP_CONTROL_kHz IN_LIST control_rates_kHz)
  string(REPLACE ";" ", " known "${control_rates_kHz}")
  message(FATAL_ERROR "STEADYSTEP_CONTROL_kHz is '${STEADYSTEP_CONTROL_kHz}'; expected, of "
    "${STEADYSTEP_BOARD}: ${known}${control_rates_reason}")
endif()
set(STEADYSTEP_LAWS "${default_laws}" CACHE STRING
  "Position laws that the image carries, by their names, separated by semicolons; all")
math(EXPR control_period_us "1000 / ${STEADYSTEP_CONTROL_kHz}")
find_package(Python3 REQUIRED COMPONENTS Interpreter)
include(Cmsis)

# find_pin_map(<name or path> <variable>): the path of a pin map.
function(find_pin_map name variable)
  if(name MATCHES "\\.h$")
    get_filename_component(path ${name} ABSOLUTE BASE_DIR ${PROJECT_SOURCE_DIR})
  else()
    set(path ${CMAKE_CURRENT_SOURCE_DIR}/pin_maps/${name}.h)
  endif()
  if(NOT EXISTS ${path})
    file(GLOB known RELATIVE ${CMAKE_CURRENT_SOURCE_DIR}/pin_maps
      ${CMAKE_CURRENT_SOURCE_DIR}/pin_maps/*.h)
    string(REPLACE ".h" "" known "${known}")
    string(REPLACE ";" ", " known "${known}")
    message(FATAL_ERROR "STEADYSTEP_PIN_MAP is '${name}': there is no ${path}; expected ${known}, "
      "or the path of a header, from the root of the project or absolute")
  endif()
  set(${variable} ${path} PARENT_SCOPE)
endfunction()

# check_motor(<path>): whether its values go together, as the simulator has it, where that is built.
function(check_motor path)
  set(host_build ${PROJECT_SOURCE_DIR}/build/sil)
  if(STEADYSTEP_HOST_BUILD)
    set(host_build ${STEADYSTEP_HOST_BUILD})
  endif()
  if(NOT EXISTS ${host_build}/steadystep-sil)
    message(STATUS "the values of ${path} are not checked: there is no ${host_build}/steadystep-sil")
    return()
  endif()
  execute_process(COMMAND ${host_build}/steadystep-sil check-motor ${path}
    OUTPUT_VARIABLE report ERROR_VARIABLE complaint RESULT_VARIABLE verdict)
  if(verdict EQUAL 2)
    message(FATAL_ERROR "STEADYSTEP_MOTOR: ${complaint}")
  elseif(NOT verdict EQUAL 0)
    message(WARNING "STEADYSTEP_MOTOR: ${report}${complaint}")
  endif()
endfunction()

# find_motor(<name or path> <variable>): the path of a motor file, which has been read once.
function(find_motor name variable)
  if(name MATCHES "/|\\.toml$")
    get_filename_component(path ${name} ABSOLUTE BASE_DIR ${PROJECT_SOURCE_DIR})
  else()
    set(path ${PROJECT_SOURCE_DIR}/sil/motors/${name}.toml)
  endif()
  if(NOT EXISTS ${path})
    message(FATAL_ERROR "STEADYSTEP_MOTOR is '${name}': there is no ${path}; expected a file of "
      "sil/motors, without .toml, or the path of a motor file, from the root of the project or "
      "absolute")
  endif()
  execute_process(COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/motor_parameters.py ${path}
    OUTPUT_QUIET ERROR_VARIABLE complaint RESULT_VARIABLE refused)
  if(refused)
    message(FATAL_ERROR "STEADYSTEP_MOTOR is '${name}': ${complaint}")
  endif()
  check_motor(${path})
  set(${variable} ${path} PARENT_SCOPE)
endfunction()

# carry_laws(<target of the firmware>): what is not named is left out, and refused by name.
function(carry_laws target)
  if(STEADYSTEP_LAWS STREQUAL all)
    return()
  endif()
  file(READ ${PROJECT_SOURCE_DIR}/firmware/control/position_laws.h registry)
  string(REGEX MATCHALL "LAW\\([A-Z_]+, [a-z_]+, \"[a-z-]+\"\\)" rows "${registry}")
  list(TRANSFORM rows REPLACE ".*\"(.*)\".*" "\\1" OUTPUT_VARIABLE known)
  list(TRANSFORM rows REPLACE "LAW\\(([A-Z_]+),.*" "LAW_BIT(\\1)" OUTPUT_VARIABLE bits)
  set(carried)
  foreach(law IN LISTS STEADYSTEP_LAWS)
    list(FIND known "${law}" place)
    if(place EQUAL -1)
      string(REPLACE ";" ", " known "${known}")
      message(FATAL_ERROR "STEADYSTEP_LAWS names '${law}'; expected all, or some of: ${known}")
    endif()
    list(GET bits ${place} bit)
    list(APPEND carried ${bit})
  endforeach()
  if(NOT "state-feedback" IN_LIST STEADYSTEP_LAWS)
    message(FATAL_ERROR "STEADYSTEP_LAWS leaves out state-feedback, with which a drive starts")
  endif()
  list(REMOVE_DUPLICATES carried)
  list(JOIN carried "+" carried)
  target_compile_definitions(${target} PRIVATE "STEADYSTEP_LAWS=${carried}")
endfunction()

# carry(<target of the firmware> <part> <default> <what it is>): option STEADYSTEP_<part>.
function(carry target part default what)
  option(STEADYSTEP_${part} "Carry ${what}" ${default})
  if(NOT STEADYSTEP_${part})
    target_compile_definitions(${target} PUBLIC STEADYSTEP_WITHOUT_${part})
  endif()
endfunction()

# carry_operation(<target of the firmware> <default>): what a machine operates the drive by.
function(carry_operation target default)
  carry(${target} LINK ${default} "the CANopen link (firmware/link)")
  carry(${target} MACHINE_IO ${default} "switches and lamps (firmware/application/machine_io.h)")
endfunction()

find_pin_map(${STEADYSTEP_PIN_MAP} pin_map)
find_motor(${STEADYSTEP_MOTOR} motor)

# board_image_source(<file> <number format>): version and default motor; looked at in every build,
# written when something has changed.
function(board_image_source file numeric)
  set(shifts)
  if(numeric STREQUAL one_motor)
    set(shifts --shifts ${coefficient_shifts})
  endif()
  add_custom_target(board_image_source
    COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/tools/board_image.py
            --root ${PROJECT_SOURCE_DIR} --motor ${motor} --version ${PROJECT_VERSION}
            --board ${STEADYSTEP_BOARD} --pin-map ${pin_map} --numeric ${numeric} ${shifts}
            "--flags=${CMAKE_C_FLAGS} ${CMAKE_C_FLAGS_RELEASE}" ${file}
    BYPRODUCTS ${file}
    VERBATIM)
endfunction()

# board_program(<target> <path of a pin map>): what every program of a port is compiled with.
function(board_program target path)
  set_target_properties(${target} PROPERTIES PIN_MAP ${path})
  # Of the project: by its path from the root, so that an image is the same wherever it is built.
  cmake_path(IS_PREFIX PROJECT_SOURCE_DIR ${path} of_the_project)
  if(of_the_project)
    cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
  endif()
  add_dependencies(${target} board_image_source)
  target_link_libraries(${target} PRIVATE cmsis_core)
  target_compile_definitions(${target} PRIVATE
    STEADYSTEP_DEVICE="hal/${STEADYSTEP_BOARD}/device.h"
    STEADYSTEP_FAULTS="hal/${STEADYSTEP_BOARD}/faults.h"
    STEADYSTEP_PIN_MAP="${path}"
    STEADYSTEP_CONTROL_PERIOD_us=${control_period_us})
  set_target_properties(${target} PROPERTIES SUFFIX .elf)
  target_link_options(${target} PRIVATE
    -T ${CMAKE_CURRENT_SOURCE_DIR}/memory.ld -Wl,--build-id=none)
endfunction()

# pack_image(<target>): packs what the program unpacks to RAM.
function(pack_image target)
  set(tools ${PROJECT_SOURCE_DIR}/tools)
  add_custom_command(TARGET ${target} POST_BUILD
    COMMAND ${tools}/pack_image $<TARGET_FILE:${target}> VERBATIM)
  set_property(TARGET ${target} APPEND PROPERTY
    LINK_DEPENDS ${tools}/pack_image ${tools}/arm_image/packing.py)
endfunction()

# interrupt_sections(<target>... [IN_FLASH <function>...]): interrupt_sections.ld, which the linker
# script of the targets includes: what the control interrupt reaches, but for functions that stay in
# flash. The image with nothing of it placed, `unplaced`, shows it; its sources are the caller's.
function(interrupt_sections)
  cmake_parse_arguments(PARSE_ARGV 0 placed "" "" "IN_FLASH")
  set(sections ${CMAKE_CURRENT_BINARY_DIR}/interrupt_sections.ld)
  set(no_sections ${CMAKE_CURRENT_BINARY_DIR}/unplaced)
  file(MAKE_DIRECTORY ${no_sections})
  file(TOUCH ${no_sections}/interrupt_sections.ld)
  add_executable(unplaced)
  board_program(unplaced ${pin_map})
  # It is never packed, nor flashed: where flash is scarce, memory.ld gives it more.
  target_link_options(unplaced PRIVATE -L ${no_sections} -Wl,--defsym=unpacked=1)
  file(GLOB image_readers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tools/arm_image/*.py)
  add_custom_command(OUTPUT ${sections}
    COMMAND ${PROJECT_SOURCE_DIR}/tools/interrupt_sections
            $<TARGET_FILE:unplaced> ${sections} ${placed_IN_FLASH}
    DEPENDS unplaced ${PROJECT_SOURCE_DIR}/tools/interrupt_sections ${image_readers}
    COMMENT "What the control interrupt reaches"
    VERBATIM)
  add_custom_target(interrupt_sections DEPENDS ${sections})
  foreach(program IN LISTS placed_UNPARSED_ARGUMENTS)
    add_dependencies(${program} interrupt_sections)
    set_property(TARGET ${program} APPEND PROPERTY LINK_DEPENDS ${sections})
    target_link_options(${program} PRIVATE -L ${CMAKE_CURRENT_BINARY_DIR})
  endforeach()
endfunction()

# board_image(<target>): a program with the chosen pin map, and what is made of it.
function(board_image target)
  set(image ${PROJECT_BINARY_DIR}/${target})
  board_program(${target} ${pin_map})
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
  target_link_options(${target} PRIVATE -Wl,-Map=${image}.elf.map)
  if(STEADYSTEP_PACKED)
    pack_image(${target})
  endif()
  add_custom_command(TARGET ${target} POST_BUILD
    COMMAND ${CMAKE_OBJCOPY} -O ihex -R .unpacked.* ${image}.elf ${image}.hex
    COMMAND ${CMAKE_OBJCOPY} -O binary -R .unpacked.* ${image}.elf ${image}.bin
    COMMAND arm-none-eabi-size -A -x ${image}.elf
    COMMAND ${PROJECT_SOURCE_DIR}/tools/image_map ${image}.elf
    VERBATIM)
endfunction()
