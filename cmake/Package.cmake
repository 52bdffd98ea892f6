# SPDX-License-Identifier: Apache-2.0
# cpack, or tools/package.sh: a Debian package of what is installed, with /etc/kinemap/config.json as conffile and maintainer scripts.
set(packaging_dir ${PROJECT_SOURCE_DIR}/packaging)
set(KINEMAP_MAINTAINER "Kinemap maintainers <maintainers@kinemap.invalid>" CACHE STRING "Who answers for the Debian package")

# What only the package installs: /etc is the administrator's otherwise.
function(kinemap_packaged)
  install(${ARGN} COMPONENT package EXCLUDE_FROM_ALL)
endfunction()
set(changelog ${PROJECT_BINARY_DIR}/packaging/changelog.gz)
add_custom_command(
  OUTPUT ${changelog}
  COMMAND gzip -9nc ${packaging_dir}/changelog > ${changelog}
  DEPENDS ${packaging_dir}/changelog
  VERBATIM)
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/packaging)
add_custom_target(kinemap_changelog ALL DEPENDS ${changelog})
kinemap_packaged(FILES ${changelog} ${packaging_dir}/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
kinemap_packaged(FILES ${PROJECT_SOURCE_DIR}/config/default.json DESTINATION /etc/kinemap RENAME config.json)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME kinemap)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "live map of rooms from the motion of who walks through them")
set(CPACK_PACKAGE_DESCRIPTION
"Kinemap listens to an Xsens MVN motion-capture suit and turns what its
wearer does - sits down, runs a hand along walls, tables and screens - into
a metric, functional map of the rooms, and takes the drift out of the suit's
trajectory. No camera, no light, no markers.

This package has the daemon kinemapd with its systemd unit and live page,
and the command line kinemap.")
set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${KINEMAP_MAINTAINER})
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${packaging_dir}/conffiles ${packaging_dir}/postinst ${packaging_dir}/prerm ${packaging_dir}/postrm)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_SET_DESTDIR ON) # for /etc
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};kinemap;ALL;/" "${PROJECT_BINARY_DIR};kinemap;package;/")
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
include(CPack)
