# firmware_object(<file> <object>...): optimises the objects as a whole, once, into one relocatable
# object, so that each program with the firmware in it links in no time. Objects that were compiled
# without -flto are only joined. To the compiler it is a program, of which firmware/linkage.h says
# what is called: with -flinker-output=nolto-rel every name would stay visible, and nothing that is
# called once would be inlined. Each function keeps the level that its file was compiled with; -Os
# is for what has none: strings are not aligned to words.
function(firmware_object file)
  separate_arguments(flags UNIX_COMMAND "${CMAKE_C_FLAGS} ${CMAKE_C_FLAGS_RELEASE}")
  if(NOT CMAKE_C_COMPILER_ID STREQUAL GNU)
    set(flags)
  endif()
  add_custom_command(
    OUTPUT ${file}
    COMMAND arm-none-eabi-gcc ${flags} -Os -fno-math-errno -ffp-contract=off -ffunction-sections
            -fdata-sections -r -nostdlib -flinker-output=exec -fwhole-program -flto-partition=one -o ${file} ${ARGN}
    DEPENDS ${ARGN}
    COMMENT "Optimising the firmware as a whole"
    COMMAND_EXPAND_LISTS VERBATIM)
  set_source_files_properties(${file} PROPERTIES EXTERNAL_OBJECT TRUE GENERATED TRUE)
endfunction()
