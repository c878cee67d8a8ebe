# Headers of others that Ubuntu 20.04 does not have, or not new enough: third_party/ has them for it.

# softarm_headers_of_others(<package> <target>): what find_package did not find is taken from third_party/<package>.
function(softarm_headers_of_others package target)
  if(NOT ${package}_FOUND)
    message(STATUS "${package}: not here, or too old, so third_party/${package} is used")
    add_library(${target} INTERFACE IMPORTED GLOBAL)
    set_target_properties(${target} PROPERTIES
      INTERFACE_INCLUDE_DIRECTORIES ${PROJECT_SOURCE_DIR}/third_party/${package})
  endif()
endfunction()

find_package(CLI11 QUIET)
softarm_headers_of_others(CLI11 CLI11::CLI11)
# 3.9 has what is used, ordered_json. Debian 11 has that, Ubuntu 20.04 has not: this way both are built alike.
find_package(nlohmann_json 3.10 QUIET)
softarm_headers_of_others(nlohmann_json nlohmann_json::nlohmann_json)
