# The Python package softarm: src/python as its extension, python/softarm beside it. Without pybind11 all else is built.
#   python   the target, in the devel space; installed where it was built
set(SOFTARM_PYTHON OFF)
if(NOT SOFTARM_SANITIZE)  # Python itself would have to be built so
  # The interpreter is ROS's. pybind11 goes by what catkin looked for before, which was no headers.
  set(Python3_EXECUTABLE ${PYTHON_EXECUTABLE})
  set(python_headers Development)
  if(NOT CMAKE_VERSION VERSION_LESS 3.18)
    set(python_headers Development.Module)
  endif()
  find_package(Python3 QUIET COMPONENTS Interpreter ${python_headers})
  if(Python_FOUND)  # by one of ROS's packages, of Debian 13 for one: pybind11 prefers it
    set(Python_EXECUTABLE ${PYTHON_EXECUTABLE})
    find_package(Python QUIET COMPONENTS Interpreter ${python_headers})
  endif()
  find_package(pybind11 2.4 QUIET)
  if(pybind11_FOUND AND Python3_FOUND)
    set(SOFTARM_PYTHON ON)
  else()
    message(STATUS "Python module softarm: left out, as there is no pybind11 (Debian packages pybind11-dev python3-dev)")
  endif()
endif()
if(NOT SOFTARM_PYTHON)
  return()
endif()

set(python_folder ${CATKIN_DEVEL_PREFIX}/${CATKIN_GLOBAL_PYTHON_DESTINATION}/softarm)
softarm_sources(python_sources python)
pybind11_add_module(softarm_python MODULE NO_EXTRAS ${python_sources})
add_dependencies(softarm_python ${${PROJECT_NAME}_EXPORTED_TARGETS})
target_include_directories(softarm_python PRIVATE include src)
target_compile_options(softarm_python PRIVATE ${SOFTARM_WARNINGS})
target_compile_definitions(softarm_python PRIVATE
  SOFTARM_VERSION="${SOFTARM_VERSION}" SOFTARM_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
# First: glog brings in libunwind on Debian 11 and Ubuntu 20.04, which unwinds exceptions, too, but none that libgcc has begun.
target_link_libraries(softarm_python PRIVATE gcc_s softarm_study softarm_ros softarm_live ${CERES_LIBRARIES}
  fmt::fmt yaml-cpp Threads::Threads)
softarm_unity(softarm_python 4)
set_target_properties(softarm_python PROPERTIES OUTPUT_NAME _softarm LIBRARY_OUTPUT_DIRECTORY ${python_folder})

file(GLOB python_files CONFIGURE_DEPENDS python/softarm/*.py python/softarm/*.pyi python/softarm/py.typed)
set(copies)
foreach(file IN LISTS python_files)
  get_filename_component(name ${file} NAME)
  add_custom_command(OUTPUT ${python_folder}/${name} COMMAND ${CMAKE_COMMAND} -E copy ${file} ${python_folder}/${name}
    DEPENDS ${file})
  list(APPEND copies ${python_folder}/${name})
endforeach()
add_custom_target(python ALL DEPENDS softarm_python ${copies})
# It does not know that pybind11_add_module makes a target.
#catkin_lint: ignore_once undefined_target
install(TARGETS softarm_python OPTIONAL LIBRARY DESTINATION ${CATKIN_GLOBAL_PYTHON_DESTINATION}/softarm)
install(FILES ${python_files} DESTINATION ${CATKIN_GLOBAL_PYTHON_DESTINATION}/softarm)
