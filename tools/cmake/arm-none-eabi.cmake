# Cross build for an Arm Cortex-M core, run under QEMU.
# STEADYSTEP_CORE: m4f (Cortex-M4 with single-precision FPU) or m0plus (Cortex-M0+).
# STEADYSTEP_COMPILER: gcc, or clang with the libraries and the linker of the gcc toolchain.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)

set(STEADYSTEP_CORE m4f CACHE STRING "Arm core: m4f or m0plus")
set(STEADYSTEP_COMPILER gcc CACHE STRING "Arm compiler: gcc or clang")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES STEADYSTEP_CORE STEADYSTEP_COMPILER)

if(STEADYSTEP_CORE STREQUAL "m4f")
  # softfp: design and planning are in double, of which no part is passed in the FPU's registers
  set(core_flags "-mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=softfp")
  set(machine mps2-an386)
elseif(STEADYSTEP_CORE STREQUAL "m0plus")
  # QEMU has no Cortex-M0+; its Cortex-M0 machine executes the same instruction set, ARMv6-M.
  set(core_flags "-mcpu=cortex-m0plus -mthumb -mfloat-abi=soft")
  # Without optimisation the whole firmware and a recording are larger than the machine's flash.
  set(machine microbit -global nrf51-soc.flash-size=524288)
else()
  message(FATAL_ERROR "STEADYSTEP_CORE is '${STEADYSTEP_CORE}'; expected m4f or m0plus")
endif()
set(CMAKE_C_FLAGS_INIT "${core_flags} -ffreestanding -fno-common")

if(STEADYSTEP_COMPILER STREQUAL "gcc")
  set(CMAKE_C_COMPILER arm-none-eabi-gcc)
  # Two halfwords that are stored side by side it would put together in a register, in more
  # instructions than two stores: the duties, in every control interrupt.
  string(APPEND CMAKE_C_FLAGS_INIT " -fno-tree-slp-vectorize")
  if(STEADYSTEP_CORE STREQUAL "m0plus")
    # Eight registers do not hold what partial redundancy elimination keeps alive: without it the
    # control interrupt is 4 % shorter (tools/cycles).
    string(APPEND CMAKE_C_FLAGS_INIT " -fno-tree-pre")
  endif()
elseif(STEADYSTEP_COMPILER STREQUAL "clang")
  set(CMAKE_C_COMPILER clang)
  set(CMAKE_C_COMPILER_TARGET arm-none-eabi)
  execute_process(COMMAND arm-none-eabi-gcc -print-file-name=libc.a
    OUTPUT_VARIABLE libc OUTPUT_STRIP_TRAILING_WHITESPACE)
  cmake_path(GET libc PARENT_PATH libraries)
  # The library is gcc's and has its short enumerations: one layout of the drive for both compilers.
  string(APPEND CMAKE_C_FLAGS_INIT " -fshort-enums -isystem ${libraries}/../include")
  set(CMAKE_C_LINK_EXECUTABLE
    "arm-none-eabi-gcc ${core_flags} <LINK_FLAGS> <CMAKE_C_LINK_FLAGS> <OBJECTS> -o <TARGET> <LINK_LIBRARIES>")
else()
  message(FATAL_ERROR "STEADYSTEP_COMPILER is '${STEADYSTEP_COMPILER}'; expected gcc or clang")
endif()

set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY) # no program links without tests/target/startup.c
set(CMAKE_EXE_LINKER_FLAGS_INIT
  "-nostartfiles --specs=nano.specs --specs=nosys.specs -Wl,--gc-sections -Wl,--no-warn-rwx-segments")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)

set(CMAKE_CROSSCOMPILING_EMULATOR
  timeout 120 qemu-system-arm -M ${machine} -nodefaults -display none
  -chardev stdio,id=text -semihosting-config enable=on,target=native,chardev=text -kernel)
