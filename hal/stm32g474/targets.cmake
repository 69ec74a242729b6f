# Targets that need a board and a tool; without the tool they say what is missing.
set(openocd_files -f interface/stlink.cfg -f target/stm32g4x.cfg)

# add_tool_target(<target> <program> <package> COMMAND...): the program is looked for when the target
# is built.
function(add_tool_target target program package)
  set(missing "${target}: ${program} is not installed; it is in the package ${package}")
  add_custom_target(${target}
    COMMAND sh -c "command -v ${program} >/dev/null || { echo '${missing}'; exit 1; }"
    COMMAND ${program} ${ARGN}
    DEPENDS steadystep USES_TERMINAL VERBATIM)
endfunction()

add_tool_target(flash openocd openocd
  ${openocd_files} -c "program ${image}.elf verify reset exit")
add_tool_target(debug openocd openocd ${openocd_files} -c "init" -c "reset halt")
add_tool_target(flash-st st-flash stlink-tools
  --reset --format ihex write ${image}.hex)
