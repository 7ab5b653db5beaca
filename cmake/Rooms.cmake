# canopus_together(TARGET [FILES n] source...): compiles several files together: headers are read, and templates instantiated,
# once for all of them, which takes a third of the time. Groups are the files of each folder, ten at a time; a folder of at
# most four files is in the group of the one before it, where that has fewer than ten. Names within anonymous namespaces
# must differ within a group. With FILES, groups are n files of the whole target, or fewer, and of about the same size, so
# that none is left to compile alone at the end.
function(canopus_together target)
  cmake_parse_arguments(ARG "" "FILES" "" ${ARGN})
  if(ARG_FILES)
    canopus_groups_of_size(${target} ${ARG_FILES} ${ARG_UNPARSED_ARGUMENTS})
  else()
    canopus_groups_of_folders(${target} ${ARG_UNPARSED_ARGUMENTS})
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # g++ takes a file that another one includes for a header.
  target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
endfunction()

function(canopus_groups_of_size target most)
  set(total 0)
  foreach(source ${ARGN})
    file(SIZE ${source} size)
    math(EXPR total "${total} + ${size}")
  endforeach()
  list(LENGTH ARGN files)
  math(EXPR groups "(${files} + ${most} - 1) / ${most}")
  set(done 0)
  foreach(source ${ARGN})
    # The group in which the middle of the file lies.
    file(SIZE ${source} size)
    math(EXPR part "(2 * ${done} + ${size}) * ${groups} / (2 * ${total})")
    math(EXPR done "${done} + ${size}")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${target}_${part})
  endforeach()
endfunction()

function(canopus_groups_of_folders target)
  set(folders)
  foreach(source ${ARGN})
    cmake_path(GET source PARENT_PATH folder)
    list(APPEND folders ${folder})
    string(MAKE_C_IDENTIFIER ${folder} id)
    math(EXPR files_${id} "0${files_${id}} + 1")
  endforeach()
  list(REMOVE_DUPLICATES folders)
  set(group)
  set(count 10)
  foreach(folder ${folders})
    string(MAKE_C_IDENTIFIER ${folder} id)
    if(files_${id} GREATER 4)
      set(count 10)  # it begins a group
    endif()
    cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} OUTPUT_VARIABLE name)
    set(part 0)
    foreach(source ${ARGN})
      cmake_path(GET source PARENT_PATH parent)
      if(NOT parent STREQUAL folder)
        continue()
      endif()
      if(count GREATER_EQUAL 10)
        string(MAKE_C_IDENTIFIER "${name}_${part}" group)
        math(EXPR part "${part} + 1")
        set(count 0)
      endif()
      math(EXPR count "${count} + 1")
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endforeach()
  endforeach()
endfunction()

function(canopus_position_independent target)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${target} PRIVATE -fno-semantic-interposition -fvisibility=hidden)
endfunction()

# canopus_room(NAME [ROOMS room...] [LIBRARIES target...] [PRIVATE_LIBRARIES target...])
#
# One static library per room, from canopus/NAME/**.cpp (a main.cpp is a program's, so that tests reach the rest). Includes
# read "canopus/NAME/thing.hpp"; a room's headers are reached through a folder of its own that holds nothing but a link to
# them, so a room that does not name another in ROOMS (directly or through one it names) cannot include its headers. PRIVATE_LIBRARIES
# are of headers alone, which no header of the room includes: who links the room needs them not.
function(canopus_room name)
  cmake_parse_arguments(ARG "" "" "ROOMS;LIBRARIES;PRIVATE_LIBRARIES" ${ARGN})
  set(root ${CMAKE_CURRENT_SOURCE_DIR}/canopus/${name})
  set(headers ${CMAKE_BINARY_DIR}/rooms/${name})
  file(MAKE_DIRECTORY ${headers}/canopus)
  file(CREATE_LINK ${root} ${headers}/canopus/${name} SYMBOLIC)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${root}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/main.cpp$")
  if(sources)
    add_library(canopus_${name} STATIC ${sources})
    if(CANOPUS_TOGETHER)
      canopus_together(canopus_${name} ${sources})
    endif()
    set(scope PUBLIC)
    target_link_libraries(canopus_${name} PRIVATE $<BUILD_INTERFACE:canopus_options>)
    foreach(library ${ARG_PRIVATE_LIBRARIES})
      target_link_libraries(canopus_${name} PRIVATE $<BUILD_INTERFACE:${library}>)
    endforeach()
    if(CANOPUS_PYTHON)  # the module of python/ is a shared object
      canopus_position_independent(canopus_${name})
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

# canopus_embed(TARGET FOLDER folder PATTERNS a,b HEADER header NAMESPACE name TYPE type FUNCTION function): files of a folder as a
# source of the target (EmbeddedFiles.cmake).
function(canopus_embed target)
  cmake_parse_arguments(ARG "" "FOLDER;PATTERNS;HEADER;NAMESPACE;TYPE;FUNCTION" "" ${ARGN})
  set(folder ${CMAKE_CURRENT_SOURCE_DIR}/${ARG_FOLDER})
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${ARG_FUNCTION}.cpp)
  set(script ${CMAKE_CURRENT_SOURCE_DIR}/cmake/EmbeddedFiles.cmake)
  string(REPLACE "," ";" patterns "${ARG_PATTERNS}")
  list(TRANSFORM patterns PREPEND ${folder}/)
  file(GLOB files CONFIGURE_DEPENDS ${patterns})
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -D FOLDER=${folder} -D PATTERNS=${ARG_PATTERNS} -D HEADER=${ARG_HEADER} -D NAMESPACE=${ARG_NAMESPACE}
            -D TYPE=${ARG_TYPE} -D FUNCTION=${ARG_FUNCTION} -D OUTPUT=${output} -P ${script}
    DEPENDS ${files} ${script} VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()
