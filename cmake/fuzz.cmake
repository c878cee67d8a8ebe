# Targets of libFuzzer, each an executable fuzz_<name>; they need clang: scripts/fuzz. Of the package only what they run is
# compiled.
#catkin_lint: ignore uninstalled_target
if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  message(FATAL_ERROR "SOFTARM_SANITIZE=fuzz needs clang: -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++")
endif()
softarm_sources(fuzzed_sources math arm trial)
foreach(name IN ITEMS any_input_topic associated_bodies bag_frames bag_message bag_recording bag_structure body_drivers
    body_reader driver_drawn_points driver_mocap_markers driver_odometry driver_phasespace driver_point_cloud
    driver_point_cloud2 driver_point_stamped driver_pose_stamped driver_tf driver_transform_stamped driver_vicon_markers
    input_topics labelled_bodies marker_list message_schema open_bag scalar_adapters)
  list(APPEND fuzzed_sources src/ros/${name}.cpp)
endforeach()
add_library(softarm_fuzzed STATIC ${fuzzed_sources})
target_include_directories(softarm_fuzzed PUBLIC include src)
target_compile_options(softarm_fuzzed PRIVATE ${SOFTARM_WARNINGS})
add_dependencies(softarm_fuzzed ${${PROJECT_NAME}_EXPORTED_TARGETS})
target_link_libraries(softarm_fuzzed PUBLIC ${catkin_LIBRARIES} Eigen3::Eigen ${CERES_LIBRARIES} yaml-cpp fmt::fmt
  nlohmann_json::nlohmann_json Boost::headers Threads::Threads)
softarm_precompile(softarm_fuzzed)
softarm_unity(softarm_fuzzed 8)

set(fuzz_parts ${PROJECT_SOURCE_DIR}/test/fuzz)
foreach(name IN ITEMS arm bag csv message scenario)
  add_executable(fuzz_${name} EXCLUDE_FROM_ALL ${fuzz_parts}/libfuzzer.cpp ${fuzz_parts}/${name}_target.cpp)
  target_include_directories(fuzz_${name} PRIVATE test)
  target_compile_options(fuzz_${name} PRIVATE ${SOFTARM_WARNINGS})
  target_compile_definitions(fuzz_${name} PRIVATE
    SOFTARM_FUZZ_TARGET=${name} SOFTARM_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_link_libraries(fuzz_${name} PRIVATE softarm_fuzzed)
  target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
  set_target_properties(fuzz_${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/fuzz)
  list(APPEND fuzz_targets fuzz_${name})
endforeach()
target_link_libraries(fuzz_scenario PRIVATE softarm_rig)
add_custom_target(fuzz DEPENDS ${fuzz_targets})
