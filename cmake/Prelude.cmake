# canopus_prelude(NAME [FMT] ROOMS room... OPTIONS option...): the headers of the standard library that most files read, with FMT that of
# fmt, too, are compiled once for these rooms, which are compiled with the same options. None of the project's own headers: what a room
# may see stays what CMakeLists.txt says. Each file still includes what it uses: a build without CANOPUS_TOGETHER has no such header.
set(CANOPUS_PRELUDE_HEADERS <algorithm> <array> <bitset> <charconv> <chrono> <cstdint> <cstring> <deque> <expected> <filesystem> <functional>
                            <map> <memory> <optional> <set> <span> <string> <string_view> <utility> <vector>)

function(canopus_prelude name)
  cmake_parse_arguments(ARG "FMT" "" "ROOMS;OPTIONS" ${ARGN})
  file(CONFIGURE OUTPUT ${name}.cpp CONTENT "// Nothing but a place for a precompiled header.\n")
  add_library(${name} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  target_compile_features(${name} PRIVATE cxx_std_23)
  target_link_libraries(${name} PRIVATE canopus_options)
  target_compile_options(${name} PRIVATE ${ARG_OPTIONS})
  if(CANOPUS_PYTHON)
    canopus_position_independent(${name})
  endif()
  target_precompile_headers(${name} PRIVATE ${CANOPUS_PRELUDE_HEADERS})
  if(ARG_FMT)
    target_link_libraries(${name} PRIVATE fmt::fmt)
    target_precompile_headers(${name} PRIVATE <fmt/format.h>)
  endif()
  foreach(room ${ARG_ROOMS})
    target_precompile_headers(canopus_${room} REUSE_FROM ${name})
    target_compile_options(canopus_${room} PRIVATE ${ARG_OPTIONS})
  endforeach()
endfunction()
