# Targets `flash`, `flash-st` and `debug`, which need a board and a tool; without the tool they say
# what is missing. The port sets openocd_chip, a file of OpenOCD's target/.
#
# The core is held in reset while the debugger connects: what runs on the board cannot keep it out.
set(image ${PROJECT_BINARY_DIR}/steadystep)
set(openocd_files -f interface/stlink.cfg -f target/${openocd_chip}
  -c "reset_config srst_only srst_nogate connect_assert_srst")

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
  --connect-under-reset --reset --format ihex write ${image}.hex)
