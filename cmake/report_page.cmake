# The plotting library that report.html carries inside: Plotly, out of Debian's python3-plotly, made smaller (8.7 MB to
# 3.8 MB) by esbuild where that is there. Without either the report has its sentences and tables, and says what is missing.
find_file(PLOTLY_JS NAMES plotly.min.js plotly.js
  PATHS /usr/share/python3-plotly /usr/share/javascript/plotly /usr/share/javascript/plotly.js NO_DEFAULT_PATH
  DOC "plotly.js, the plots of report.html")
find_program(ESBUILD esbuild DOC "makes plotly.js smaller")

set(SOFTARM_PLOTLY)
set(head)
if(PLOTLY_JS)
  file(READ ${PLOTLY_JS} head LIMIT 400)
endif()
if(head MATCHES "plotly\\.js v[01]\\.")
  message(STATUS "plotly.js is older than 2: it runs text as code, which the page forbids. report.html will have no plots")
elseif(PLOTLY_JS)
  set(SOFTARM_PLOTLY ${PROJECT_BINARY_DIR}/report/plotly.min.js)
  if(ESBUILD AND NOT PLOTLY_JS MATCHES "\\.min\\.js$")
    # The licence's comment stays in front.
    string(REGEX MATCH "/\\*[^/]*\\*/" licence "${head}")
    string(REGEX REPLACE "[\r\n]+" " " licence "${licence}")
    set(make_plotly ${ESBUILD} --minify --legal-comments=inline --log-level=error "--banner:js=${licence}"
      --outfile=${SOFTARM_PLOTLY} ${PLOTLY_JS})
  else()
    set(make_plotly ${CMAKE_COMMAND} -E copy ${PLOTLY_JS} ${SOFTARM_PLOTLY})
  endif()
  add_custom_command(OUTPUT ${SOFTARM_PLOTLY}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/report
    COMMAND ${make_plotly} DEPENDS ${PLOTLY_JS} COMMENT "Packing plotly.js for the reports" VERBATIM)
  add_custom_target(report_page ALL DEPENDS ${SOFTARM_PLOTLY})
  if(SOFTARM_WITH_ROS)
    # Beside the program in the devel space too, where it looks first.
    add_custom_command(TARGET report_page POST_BUILD
      COMMAND ${CMAKE_COMMAND} -E make_directory ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_SHARE_DESTINATION}/config/report
      COMMAND ${CMAKE_COMMAND} -E copy_if_different ${SOFTARM_PLOTLY}
      ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_SHARE_DESTINATION}/config/report/plotly.min.js VERBATIM)
    add_dependencies(programs report_page)
    install(FILES ${SOFTARM_PLOTLY} DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}/config/report OPTIONAL)
  endif()
else()
  message(STATUS "No plotly.js (Debian: python3-plotly; or -DPLOTLY_JS=FILE): report.html will have no plots")
endif()
