# canopus_room(NAME [ROOMS room...] [LIBRARIES target...])
#
# One static library per room, from canopus/NAME/**.cpp (a main.cpp is a program's, so that tests reach the rest). Includes
# read "canopus/NAME/thing.hpp"; a room's headers are reached through a folder of its own that holds nothing but a link to
# them, so a room that does not name another in ROOMS (directly or through one it names) cannot include its headers.
function(canopus_room name)
  cmake_parse_arguments(ARG "" "" "ROOMS;LIBRARIES" ${ARGN})
  set(root ${CMAKE_CURRENT_SOURCE_DIR}/canopus/${name})
  set(headers ${CMAKE_BINARY_DIR}/rooms/${name})
  file(MAKE_DIRECTORY ${headers}/canopus)
  file(CREATE_LINK ${root} ${headers}/canopus/${name} SYMBOLIC)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${root}/*.cpp)
  list(REMOVE_ITEM sources ${root}/main.cpp)
  if(sources)
    add_library(canopus_${name} STATIC ${sources})
    set(scope PUBLIC)
    target_link_libraries(canopus_${name} PRIVATE canopus_options)
  else()
    add_library(canopus_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(canopus::${name} ALIAS canopus_${name})  # for projects that add_subdirectory() this one
  target_include_directories(canopus_${name} ${scope} ${headers})
  list(TRANSFORM ARG_ROOMS PREPEND canopus_)
  target_link_libraries(canopus_${name} ${scope} ${ARG_ROOMS} ${ARG_LIBRARIES})
endfunction()
