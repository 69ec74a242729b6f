# The virtual STM32G071 board, for the tests of the preset board-stm32g071.
add_custom_target(stm32g071_runs)
foreach(name IN ITEMS stm32g071_run stm32g071_disturbances)
  add_executable(${name} ${CMAKE_CURRENT_LIST_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE virtual_board sil_board drive_interface)
  add_dependencies(stm32g071_runs ${name})
endforeach()
