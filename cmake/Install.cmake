# SPDX-License-Identifier: Apache-2.0
# cmake --install build/release [--prefix /usr]: the two programs, their manual pages, completion and the service.
include(GNUInstallDirs)
set(said ${PROJECT_BINARY_DIR}/tools/kinemap)
install(TARGETS kinemap kinemapd)
install(FILES ${said}/kinemap.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${PROJECT_SOURCE_DIR}/daemon/kinemapd.8 DESTINATION ${CMAKE_INSTALL_MANDIR}/man8)
install(FILES ${said}/kinemap.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME kinemap)
install(FILES ${said}/_kinemap DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
install(FILES ${said}/kinemap.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(FILES ${PROJECT_SOURCE_DIR}/systemd/kinemapd.service DESTINATION lib/systemd/system)
install(FILES ${PROJECT_SOURCE_DIR}/config/default.json DESTINATION ${CMAKE_INSTALL_DATADIR}/kinemap) # /etc is the administrator's
