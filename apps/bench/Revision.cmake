# Writes Revision.h, only where it would change: cmake -D SOURCE=... -D HEADER=... -P Revision.cmake
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND git -C ${SOURCE} describe --always --abbrev=7 --dirty=+ --exclude=*
  OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT revision)
  set(revision "unknown")
endif()
file(CONFIGURE OUTPUT ${HEADER} CONTENT
  "// SPDX-License-Identifier: Apache-2.0\nstatic const char* const kRevision = \"@revision@\";\n" @ONLY)
