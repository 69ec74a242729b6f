# stm32g071_run: the virtual STM32G071 board, for the tests of the preset board-stm32g071.
add_executable(stm32g071_run EXCLUDE_FROM_ALL ${CMAKE_CURRENT_LIST_DIR}/stm32g071_run.cpp)
target_link_libraries(stm32g071_run PRIVATE virtual_board sil_board drive_interface)
