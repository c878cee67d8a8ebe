# Targets by convention: a new file in a room, a new program or a new test is found without an edit here.

# Warnings are errors in our own code.
set(SOFTARM_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Werror)

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
    set_target_properties(${target} PROPERTIES INCLUDE_DIRECTORIES ${PROJECT_SOURCE_DIR}/include)
  endforeach()
endfunction()

# softarm_programs(<library>...): one program per src/apps/<name>.cpp, with src/apps/<name>/**.cpp where its main() is
# not all of it. Their names are left in the cache variable SOFTARM_PROGRAMS.
function(softarm_programs)
  set(names)
  file(GLOB mains CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/apps/*.cpp)
  foreach(main IN LISTS mains)
    get_filename_component(name ${main} NAME_WE)
    file(GLOB_RECURSE parts CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/apps/${name}/*.cpp)
    add_executable(${name} ${main} ${parts})
    add_dependencies(${name} ${${PROJECT_NAME}_EXPORTED_TARGETS})
    target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/src/apps)
    target_compile_options(${name} PRIVATE ${SOFTARM_WARNINGS})
    target_compile_definitions(${name} PRIVATE
      SOFTARM_VERSION="${${PROJECT_NAME}_VERSION}" SOFTARM_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    target_link_libraries(${name} PRIVATE ${ARGN})
    set_target_properties(${name} PROPERTIES
      INSTALL_RPATH "$ORIGIN/.."  # from lib/softarm_estimator to lib
      RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})
    install(TARGETS ${name} RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
    list(APPEND names ${name})
  endforeach()
  set(SOFTARM_PROGRAMS "${names}" CACHE INTERNAL "programs of src/apps")
  # What scripts/demo and scripts/softarm need: no tests.
  add_custom_target(programs DEPENDS ${names} ${${PROJECT_NAME}_EXPORTED_TARGETS})
endfunction()
