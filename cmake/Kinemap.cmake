# SPDX-License-Identifier: Apache-2.0
# Helpers shared by every folder: warnings, sanitizers, ccache, and one way to declare a target.

set(KINEMAP_SANITIZE "" CACHE STRING "Sanitizers for every target, e.g. 'address,undefined' or 'thread'")
option(KINEMAP_WERROR "Treat warnings in our own targets as errors" ON)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

if(KINEMAP_SANITIZE)
  add_compile_options(-fsanitize=${KINEMAP_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${KINEMAP_SANITIZE})
  if(KINEMAP_SANITIZE MATCHES undefined)
    add_compile_options(-fno-sanitize-recover=undefined)
  endif()
  if(KINEMAP_SANITIZE MATCHES thread)
    add_compile_options(-Wno-tsan) # Asio's fences beside its mutexes; the sanitizer sees the mutexes
  endif()
endif()

# What is tested is what ships: Debian's hardening=+all, and no path of this machine in a binary (tests/hardening).
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  add_compile_options(-fPIE -fstack-protector-strong -D_FORTIFY_SOURCE=2 -Wformat -Werror=format-security
    -ffile-prefix-map=${PROJECT_SOURCE_DIR}=.)
  add_link_options(-pie LINKER:-z,relro,-z,now)
endif()

# For libFuzzer (clang only): everything tells it which ways were taken; tests/fuzz.
option(KINEMAP_FUZZ "Have libFuzzer drive the fuzz targets" OFF)
if(KINEMAP_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES Clang)
    message(FATAL_ERROR "KINEMAP_FUZZ needs clang++: cmake --preset fuzz")
  endif()
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# Bits must not depend on the build machine: no -march=native, no -ffast-math.
function(kinemap_defaults target)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion)
  if(KINEMAP_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# kinemap_library(name SOURCES … LINK …): a static library of ours; headers are included as "folder/file.hpp".
function(kinemap_library name)
  cmake_parse_arguments(A "" "" "SOURCES;LINK" ${ARGN})
  add_library(${name} STATIC ${A_SOURCES})
  kinemap_defaults(${name})
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC ${A_LINK})
endfunction()

# kinemap_program(name SOURCES … LINK …)
function(kinemap_program name)
  cmake_parse_arguments(A "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${A_SOURCES})
  kinemap_defaults(${name})
  target_link_libraries(${name} PRIVATE ${A_LINK})
endfunction()

# kinemap_test(name SOURCES … LINK …): a GoogleTest program, run by ctest as one entry.
# It finds recordings in KINEMAP_SHARED_DATA (may be absent: such tests skip, loudly) and fixtures in KINEMAP_SOURCE_DIR.
function(kinemap_test name)
  cmake_parse_arguments(A "" "" "SOURCES;LINK;DEPENDS" ${ARGN})
  kinemap_program(${name} SOURCES ${A_SOURCES} LINK ${A_LINK} GTest::gtest GTest::gmock GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE
    KINEMAP_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    KINEMAP_BINARY_DIR="${PROJECT_BINARY_DIR}"
    KINEMAP_SHARED_DATA="${PROJECT_SOURCE_DIR}/../shared/data")
  if(A_DEPENDS)
    add_dependencies(${name} ${A_DEPENDS})
  endif()
  add_test(NAME ${name} COMMAND ${name})
endfunction()
