# cmake --install: sightline::runtime and, where they are built, sightline::pvs and sightline::layers, their
# headers, the package that find_package(sightline) reads, and a file for pkg-config of each. The other libraries serve
# the tool and are not installed; the tool is, as the component `tool`, with its manual and its completion.

include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/sightline)

# Installs sightline-COMPONENT.pc, for projects that do not use CMake. needs: names of pkg-config. The libraries are
# static, so `pkg-config --libs` has to name what they use without being told --static: it is in Requires, not in
# Requires.private.
function(sightline_install_pc component needs description)
  set(pc_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
  set(prefix ${CMAKE_INSTALL_PREFIX})
  if(NOT IS_ABSOLUTE ${CMAKE_INSTALL_LIBDIR})
    # From where the file lies, so that the prefix may be chosen when it is installed, and moved afterwards.
    file(RELATIVE_PATH prefix /${pc_dir} /)
    string(REGEX REPLACE "/$" "" prefix "\${pcfiledir}/${prefix}")
  endif()
  foreach(dir LIBDIR INCLUDEDIR)
    string(TOLOWER ${dir} name)
    set(${name} ${CMAKE_INSTALL_${dir}})
    if(NOT IS_ABSOLUTE ${${name}})
      set(${name} "\${prefix}/${${name}}")
    endif()
  endforeach()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/sightline.pc.in ${PROJECT_BINARY_DIR}/sightline-${component}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/sightline-${component}.pc DESTINATION ${pc_dir} COMPONENT ${component})
endfunction()

install(TARGETS sightline_runtime EXPORT sightlineTargets COMPONENT runtime
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime)
foreach(room base math geometry scene hierarchy occluders occlusion culling world)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/sightline/${room}
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sightline COMPONENT runtime FILES_MATCHING PATTERN "*.h")
endforeach()
install(EXPORT sightlineTargets NAMESPACE sightline:: DESTINATION ${package_dir} COMPONENT runtime)
sightline_install_pc(runtime libhwy "Conservative occlusion culling")

if(TARGET sightline_pvs)
  install(TARGETS sightline_pvs EXPORT sightlinePvsTargets COMPONENT pvs
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT pvs)
  foreach(room pvs/format pvs/query)
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/sightline/${room}
      DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sightline/pvs COMPONENT pvs FILES_MATCHING PATTERN "*.h")
  endforeach()
  install(EXPORT sightlinePvsTargets NAMESPACE sightline:: DESTINATION ${package_dir} COMPONENT pvs)
  sightline_install_pc(pvs "sightline-runtime = ${PROJECT_VERSION}, libzstd" "Look-up of potentially visible sets")
endif()

if(TARGET sightline_layers)
  install(TARGETS sightline_layers EXPORT sightlineLayersTargets COMPONENT layers
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT layers)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/sightline/layers
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sightline COMPONENT layers FILES_MATCHING PATTERN "*.h")
  install(EXPORT sightlineLayersTargets NAMESPACE sightline:: DESTINATION ${package_dir} COMPONENT layers)
  sightline_install_pc(layers "sightline-runtime = ${PROJECT_VERSION}, qhullstatic_r, libhwy"
    "Order in which layers must be drawn")
endif()

if(TARGET sightline_tool)
  # The manual and the completion are printed by the tool when it is linked, see tools/sightline/CMakeLists.txt.
  set(tool_dir $<TARGET_FILE_DIR:sightline_tool>)
  install(TARGETS sightline_tool RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tool)
  install(FILES ${tool_dir}/sightline.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tool)
  install(FILES ${tool_dir}/sightline.bash RENAME sightline
    DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT tool)
endif()

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/sightlineConfig.cmake.in
  ${PROJECT_BINARY_DIR}/sightlineConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sightlineConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/sightlineConfig.cmake ${PROJECT_BINARY_DIR}/sightlineConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT runtime)
