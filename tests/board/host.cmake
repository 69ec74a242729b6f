# Programs that execute an image of a board on the host, for the tests of the board presets.
# add_image_run(<program> <source>...)
function(add_image_run program)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/)
  add_executable(${program} ${ARGN})
  target_link_libraries(${program} PRIVATE virtual_board sil_board drive_interface)
  target_compile_options(${program} PRIVATE -O0) # compiles quickly; the image runs in virtual_board
  compile_together(8 ${program})
endfunction()

add_image_run(stm32g474_disturbances
  stm32g474_disturbances.cpp stm32g474_starts.cpp stm32g474_lines.cpp stm32g474_storage.cpp
  stm32g474_settings.cpp stm32g474_can.cpp stm32g474_floods.cpp)
add_image_run(stm32g071_run stm32g071_run.cpp)
add_image_run(stm32g071_disturbances stm32g071_disturbances.cpp)
