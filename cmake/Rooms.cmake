# canopus_together(TARGET source...): compiles the files of each folder together, ten at a time: headers are read once for all
# of them, which takes a third of the time. Names within anonymous namespaces must differ within a folder.
function(canopus_together target)
  set(count 0)
  foreach(source ${ARGN})
    cmake_path(GET source PARENT_PATH folder)
    if(NOT folder STREQUAL before)
      set(count 0)
    endif()
    set(before ${folder})
    math(EXPR part "${count} / 10")
    math(EXPR count "${count} + 1")
    cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} OUTPUT_VARIABLE name)
    string(MAKE_C_IDENTIFIER "${name}_${part}" group)
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # g++ takes a file that another one includes for a header.
  target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
endfunction()

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
    if(CANOPUS_TOGETHER)
      canopus_together(canopus_${name} ${sources})
    endif()
    set(scope PUBLIC)
    target_link_libraries(canopus_${name} PRIVATE $<BUILD_INTERFACE:canopus_options>)
    if(CANOPUS_PYTHON)  # the module of python/ is a shared object
      set_target_properties(canopus_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
      target_compile_options(canopus_${name} PRIVATE -fno-semantic-interposition -fvisibility=hidden)
    endif()
  else()
    add_library(canopus_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(canopus::${name} ALIAS canopus_${name})  # for projects that add_subdirectory() this one
  set_target_properties(canopus_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(canopus_${name} ${scope} cxx_std_23)
  target_include_directories(canopus_${name} ${scope} $<BUILD_INTERFACE:${headers}> $<INSTALL_INTERFACE:include>)
  list(TRANSFORM ARG_ROOMS PREPEND canopus_)
  target_link_libraries(canopus_${name} ${scope} ${ARG_ROOMS} ${ARG_LIBRARIES})
endfunction()

# canopus_install_rooms(room...): their libraries, their headers, and what find_package(canopus) needs.
function(canopus_install_rooms)
  include(CMakePackageConfigHelpers)
  set(package ${CMAKE_INSTALL_LIBDIR}/cmake/canopus)
  foreach(room ${ARGN})
    install(TARGETS canopus_${room} EXPORT canopus COMPONENT development ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
    install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/canopus/${room} COMPONENT development
            DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/canopus FILES_MATCHING PATTERN *.hpp)
  endforeach()
  install(EXPORT canopus NAMESPACE canopus:: FILE canopusTargets.cmake COMPONENT development DESTINATION ${package})
  configure_package_config_file(${CMAKE_CURRENT_SOURCE_DIR}/cmake/canopusConfig.cmake.in
                                ${CMAKE_CURRENT_BINARY_DIR}/canopusConfig.cmake INSTALL_DESTINATION ${package})
  write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/canopusConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/canopusConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/canopusConfigVersion.cmake
          COMPONENT development DESTINATION ${package})
endfunction()
