# Targets that need a board and a tool; without the tool they say what is missing.
set(openocd_files -f interface/stlink.cfg -f target/stm32g4x.cfg)

# add_tool_target(<target> <program> <package> COMMAND...)
function(add_tool_target target program package)
  find_program(tool_${program} ${program})
  if(tool_${program})
    add_custom_target(${target} COMMAND ${tool_${program}} ${ARGN}
      DEPENDS steadystep USES_TERMINAL VERBATIM)
  else()
    add_custom_target(${target}
      COMMAND ${CMAKE_COMMAND} -E echo
              "${target}: ${program} is not installed; it is in the package ${package}"
      COMMAND ${CMAKE_COMMAND} -E false
      VERBATIM)
  endif()
endfunction()

add_tool_target(flash openocd openocd
  ${openocd_files} -c "program ${image}.elf verify reset exit")
add_tool_target(debug openocd openocd ${openocd_files} -c "init" -c "reset halt")
add_tool_target(flash-st st-flash stlink-tools
  --reset --format ihex write ${image}.hex)
