# SPDX-License-Identifier: BSD-3-Clause
# Compiles CASE with COMPILER, INCLUDES and DEFINITIONS. Without an `// expect: TEXT` line it has to
# compile; with some it has to fail at its static_assert, and every TEXT has to stand in the
# compiler's message.
file(STRINGS ${CASE} expected REGEX "^// expect: ")

set(command ${COMPILER} -std=c++20 -fsyntax-only -fconcepts-diagnostics-depth=3 -DEIGEN_NO_DEBUG)
foreach(folder ${INCLUDES})
  list(APPEND command -I${folder})
endforeach()
foreach(definition ${DEFINITIONS})
  list(APPEND command -D${definition})
endforeach()
set(ENV{LC_ALL} C) # plain quotes, English
execute_process(
  COMMAND ${command} ${CASE}
  RESULT_VARIABLE status
  OUTPUT_VARIABLE said
  ERROR_VARIABLE said)

if(NOT expected)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${CASE} must compile, but:\n${said}")
  endif()
  return()
endif()

if(status EQUAL 0)
  message(FATAL_ERROR "${CASE} compiles, but must not")
endif()
foreach(line "// expect: static assertion" ${expected})
  string(REPLACE "// expect: " "" text "${line}")
  string(FIND "${said}" "${text}" position)
  if(position EQUAL -1)
    message(FATAL_ERROR "${CASE} is refused, but the message lacks \"${text}\":\n${said}")
  endif()
endforeach()
