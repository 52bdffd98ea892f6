# SPDX-License-Identifier: Apache-2.0
# Sets KINEMAP_PAGE_FILES: the source with which the daemon carries the live page, bundled by daemon/web/build.mjs.
# Nothing is downloaded here: tools/setup.sh has put the packages of daemon/web/package-lock.json in place.

set(web_dir ${PROJECT_SOURCE_DIR}/daemon/web)
find_program(NODE_PROGRAM NAMES node nodejs)
if(NOT NODE_PROGRAM OR NOT EXISTS ${web_dir}/node_modules/.package-lock.json)
  message(FATAL_ERROR "The live page needs Node.js and the packages of daemon/web/package-lock.json: run tools/setup.sh")
endif()

set(page_dir ${PROJECT_BINARY_DIR}/daemon/web)
set(KINEMAP_PAGE_FILES ${page_dir}/page_files.cpp)
# The glob only tells when to bundle again; what is in the bundle follows from the imports.
file(GLOB_RECURSE page_sources CONFIGURE_DEPENDS ${web_dir}/src/*)
add_custom_command(
  OUTPUT ${KINEMAP_PAGE_FILES}
  COMMAND ${NODE_PROGRAM} build.mjs ${page_dir}
  WORKING_DIRECTORY ${web_dir}
  DEPENDS ${page_sources} ${web_dir}/build.mjs ${web_dir}/package-lock.json ${web_dir}/node_modules/.package-lock.json
  COMMENT "Bundling the live page"
  VERBATIM)
