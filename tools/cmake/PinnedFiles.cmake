# Files of others that are fetched and never committed: each is checked against its SHA-256,
# whatever its source. `list`: name, hash, name, hash...
include_guard(GLOBAL)

# pinned_files_complete(<result> <folder> <list>)
function(pinned_files_complete result folder list)
  set(${result} TRUE PARENT_SCOPE)
  while(list)
    list(POP_FRONT list name expected)
    set(actual missing)
    if(EXISTS ${folder}/${name})
      file(SHA256 ${folder}/${name} actual)
    endif()
    if(NOT actual STREQUAL expected)
      set(${result} FALSE PARENT_SCOPE)
    endif()
  endwhile()
endfunction()

# pinned_files_download(<url of a folder> <folder> <list>)
function(pinned_files_download url folder list)
  while(list)
    list(POP_FRONT list name expected)
    file(DOWNLOAD ${url}/${name} ${folder}/${name}
      TIMEOUT 30 INACTIVITY_TIMEOUT 10 STATUS status)
    list(GET status 0 code)
    if(NOT code EQUAL 0)
      return() # a truncated file is caught by its hash
    endif()
  endwhile()
endfunction()
