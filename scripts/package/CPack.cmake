# SPDX-License-Identifier: Apache-2.0
#
# What `cpack` puts into a package, beyond the library and the program themselves. Used by
# scripts/package.sh.

# Manual pages and completions come from the program's own options.
set(pages ${PROJECT_BINARY_DIR}/package)
install(CODE "
  foreach(shell bash zsh fish)
    execute_process(COMMAND \"$<TARGET_FILE:tetvdb_cli>\" completions \${shell}
      OUTPUT_FILE \"${pages}/\${shell}\" COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
  execute_process(COMMAND \"$<TARGET_FILE:tetvdb_cli>\" manual \"${pages}/man1\" -q
    COMMAND_ERROR_IS_FATAL ANY)")
file(MAKE_DIRECTORY ${pages}/man1)
install(DIRECTORY ${pages}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR})
install(FILES ${pages}/bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  RENAME tetvdb)
install(FILES ${pages}/zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
  RENAME _tetvdb)
install(FILES ${pages}/fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
  RENAME tetvdb.fish)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/tetvdb RENAME copyright)
if(OPENVDB_USE_STATIC_LIBS) # the program contains OpenVDB, under the MPL 2.0
  install(FILES ${OpenVDB_ROOT}/LICENSE.openvdb DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/tetvdb)
endif()
install(FILES README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/tetvdb)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/tetvdb/docs
  FILES_MATCHING PATTERN "*.md" PATTERN "*.schema.json")
install(DIRECTORY scripts/blender scripts/houdini DESTINATION ${CMAKE_INSTALL_DATADIR}/tetvdb)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME tetvdb)
set(CPACK_PACKAGE_VENDOR TetVDB)
set(CPACK_PACKAGE_CONTACT "The TetVDB developers <tetvdb@localhost>")
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libtbb-dev, libopenvdb-dev, libembree-dev")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
  "Meshes into sparse OpenVDB volumes\n Triangle meshes with any defect, and tetrahedra with their attributes, become .vdb\n and .nvdb volumes, layers for 3D printers and data sets for learning.")
include(CPack)
