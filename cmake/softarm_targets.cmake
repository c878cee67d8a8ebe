# Targets by convention: a new file in a room, a new program or a new test is found without an edit here.

# Warnings are errors in our own code.
set(SOFTARM_WARNINGS -Wall -Wextra -Wpedantic -Wshadow)
# What a compiler newer than those it was tried with warns of, in libraries' headers, too, keeps nobody from building it.
if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU" OR CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  list(APPEND SOFTARM_WARNINGS -Werror)
endif()

# softarm_precompile(<target> <header>...): what nearly every file of ours includes, and these headers, is parsed once.
function(softarm_precompile target)
  target_precompile_headers(${target} PRIVATE <Eigen/Dense> <Eigen/Geometry> <fmt/format.h> <algorithm> <cmath> <cstdint>
    <functional> <map> <memory> <optional> <string> <utility> <vector> ${ARGN})
endfunction()

# softarm_headers(<name> LIBRARIES <library>... HEADERS <header>...): an empty program whose precompiled header others use
# (REUSE_FROM): they wait for it, so it is none that needs more than libraries of others. Its flags and macros must be theirs.
function(softarm_headers name)
  cmake_parse_arguments(given "" "" "LIBRARIES;HEADERS" ${ARGN})
  file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/headers/${name}.cpp CONTENT "int main() {}\n")
  add_executable(${name} ${PROJECT_BINARY_DIR}/headers/${name}.cpp)
  target_compile_options(${name} PRIVATE ${SOFTARM_WARNINGS})
  target_link_libraries(${name} PRIVATE ${given_LIBRARIES})
  softarm_precompile(${name} ${given_HEADERS})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/headers)
endfunction()

# softarm_unity(<target> <files per chunk> <room>...): the files of a folder are compiled in chunks of one size, at most
# that, so that what all of them include and the templates of Eigen that all of them use are worked out once per chunk. A
# chunk never holds files of two folders (x.cpp is of the folder x/ where there is one): a new file moves only its
# neighbours. A chunk is one translation unit, so names without linkage in it must differ. The files of the rooms that are
# named stay on their own.
function(softarm_unity target size)
  if(NOT SOFTARM_UNITY OR CMAKE_VERSION VERSION_LESS 3.18)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  set(folders)
  foreach(source IN LISTS sources)
    if(NOT source MATCHES "\\.cpp$")
      continue()
    endif()
    get_filename_component(folder ${source} DIRECTORY)
    get_filename_component(name ${source} NAME_WE)
    if(IS_DIRECTORY ${folder}/${name})
      set(folder ${folder}/${name})
    endif()
    get_filename_component(room ${folder} NAME)
    if(room IN_LIST ARGN)
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
      continue()
    endif()
    list(APPEND folders ${folder})
    list(APPEND in_${folder} ${source})
  endforeach()
  list(REMOVE_DUPLICATES folders)
  foreach(folder IN LISTS folders)
    get_filename_component(room ${folder} NAME)
    list(LENGTH in_${folder} count)
    math(EXPR chunks "(${count} + ${size} - 1) / ${size}")
    set(number 0)
    foreach(source IN LISTS in_${folder})
      math(EXPR chunk "${number} * ${chunks} / ${count}")
      math(EXPR number "${number} + 1")
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${room}_${chunk})
    endforeach()
  endforeach()
endfunction()

# softarm_sources(<variable> <room>...): the files src/<room>/**.cpp of these rooms.
function(softarm_sources variable)
  set(sources)
  foreach(room IN LISTS ARGN)
    file(GLOB_RECURSE room_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${room}/*.cpp)
    list(APPEND sources ${room_sources})
  endforeach()
  set(${variable} ${sources} PARENT_SCOPE)
endfunction()

# softarm_keep_ros_out_of(<library>...): catkin and genmsg put the include paths of ROS and of the generated messages on
# the whole directory, so also on these libraries; they are built without.
function(softarm_keep_ros_out_of)
  include_directories(SYSTEM ${CATKIN_DEVEL_PREFIX}/include)
  foreach(target IN LISTS ARGN)
    set_target_properties(${target} PROPERTIES INCLUDE_DIRECTORIES "${PROJECT_SOURCE_DIR}/include;${PROJECT_SOURCE_DIR}/src")
  endforeach()
endfunction()

# What a program and the parts that programs share are compiled with: the precompiled headers, and what else g++ is told.
function(softarm_program_target name headers)
  add_dependencies(${name} ${${PROJECT_NAME}_EXPORTED_TARGETS})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/src/apps)
  target_compile_options(${name} PRIVATE ${SOFTARM_WARNINGS} -fPIC ${ARGN})
  target_precompile_headers(${name} REUSE_FROM ${headers})
  target_compile_definitions(${name} PRIVATE
    SOFTARM_VERSION="${SOFTARM_VERSION}" SOFTARM_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  softarm_unity(${name} 24)  # CLI11 costs each chunk seconds
endfunction()

# softarm_programs(LIVE <program>... STUDY <library> SHARED <part>... LIBRARIES <library>...): one program per
# src/apps/<name>.cpp, with src/apps/<name>/**.cpp where its main() is not all of it. Those named LIVE do without the
# library STUDY. The files src/apps/softarm/<part>.cpp are compiled once, for all programs. Their names are left in the cache
# variable SOFTARM_PROGRAMS.
function(softarm_programs)
  cmake_parse_arguments(given "" "STUDY" "LIVE;SHARED;LIBRARIES" ${ARGN})
  # What counts is in the libraries: a program that nobody waits for live spends its own time on options and tables, and
  # half of its compilation would go into making them fast. g++ takes the level from the precompiled header.
  set(optimisation_of_studies $<$<CONFIG:Release>:-O1>)
  foreach(headers softarm_program_headers softarm_study_program_headers)
    softarm_headers(${headers}
      LIBRARIES Eigen3::Eigen fmt::fmt
      HEADERS <ros/ros.h> <filesystem> <fstream> <iostream>)
    # Not -fPIE, as programs are by default: the library of the room ros has these precompiled headers, too.
    target_compile_options(${headers} PRIVATE -fPIC)
  endforeach()
  target_compile_options(softarm_study_program_headers PRIVATE ${optimisation_of_studies})
  list(TRANSFORM given_SHARED REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/src/apps/softarm/\\1.cpp")
  add_library(softarm_shared_parts STATIC ${given_SHARED})
  set_target_properties(softarm_shared_parts PROPERTIES ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
  softarm_program_target(softarm_shared_parts softarm_program_headers)
  target_link_libraries(softarm_shared_parts PUBLIC ${given_LIBRARIES})
  # A diagnosis allocates all over: a tenth of its time and of its memory less than with the C library's. Where it is not
  # installed, programs do without. It is looked for without its headers, whose package brings a libunwind of its own.
  set(allocator)
  find_library(SOFTARM_ALLOCATOR NAMES tcmalloc_minimal libtcmalloc_minimal.so.4)
  if(SOFTARM_ALLOCATOR AND NOT SOFTARM_SANITIZE)
    set(allocator -Wl,--push-state,--no-as-needed ${SOFTARM_ALLOCATOR} -Wl,--pop-state)
  endif()
  set(names)
  file(GLOB mains CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/apps/*.cpp)
  foreach(main IN LISTS mains)
    get_filename_component(name ${main} NAME_WE)
    file(GLOB_RECURSE parts CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/apps/${name}/*.cpp)
    list(REMOVE_ITEM parts ${given_SHARED})
    add_executable(${name} ${main} ${parts})
    if(name IN_LIST given_LIVE)
      softarm_program_target(${name} softarm_program_headers)
    else()
      softarm_program_target(${name} softarm_study_program_headers ${optimisation_of_studies})
    endif()
    target_link_libraries(${name} PRIVATE softarm_shared_parts)
    if(NOT name IN_LIST given_LIVE)
      target_link_libraries(${name} PRIVATE ${given_STUDY} ${allocator})
    endif()
    target_link_libraries(${name} PRIVATE ${given_LIBRARIES})
    set_target_properties(${name} PROPERTIES
      RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})
    # What is built is installed: scripts/demo builds no more than it needs.
    install(TARGETS ${name} OPTIONAL RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
    list(APPEND names ${name})
  endforeach()
  set(SOFTARM_PROGRAMS "${names}" CACHE INTERNAL "programs of src/apps")
  # What scripts/demo needs, and what scripts/softarm needs: no tests.
  add_custom_target(live DEPENDS ${given_LIVE} ${${PROJECT_NAME}_EXPORTED_TARGETS})
  add_custom_target(programs DEPENDS ${names} ${${PROJECT_NAME}_EXPORTED_TARGETS})
endfunction()
