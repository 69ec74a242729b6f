# A room is a folder with a CMakeLists.txt. A missing one stops the configuration, so that no part
# of the house is left out unnoticed; -DSTEADYSTEP_ALLOW_MISSING_ROOMS=ON turns that into a warning.
option(STEADYSTEP_ALLOW_MISSING_ROOMS "Configure although rooms of the house are missing" OFF)

function(missing_room what)
  if(STEADYSTEP_ALLOW_MISSING_ROOMS)
    message(WARNING "missing: ${what}")
  else()
    message(FATAL_ERROR "missing: ${what}")
  endif()
endfunction()

macro(add_room folder)
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/CMakeLists.txt)
    add_subdirectory(${folder})
  else()
    missing_room("${CMAKE_CURRENT_SOURCE_DIR}/${folder}/CMakeLists.txt")
  endif()
endmacro()

# room_sources(<variable> <pattern>...): the files of a room, relative to the current folder. Every
# pattern must match something.
function(room_sources variable)
  set(all)
  foreach(pattern IN LISTS ARGN)
    file(GLOB found CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${pattern})
    if(NOT found)
      missing_room("${CMAKE_CURRENT_SOURCE_DIR}/${pattern}")
    endif()
    list(APPEND all ${found})
  endforeach()
  set(${variable} ${all} PARENT_SCOPE)
endfunction()
