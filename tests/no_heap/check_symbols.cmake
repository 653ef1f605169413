# SPDX-License-Identifier: BSD-3-Clause
# Compiles SOURCE with COMPILER, INCLUDES, DEFINITIONS and FLAGS to OBJECT and lists with NM what the
# object expects from others: no allocator, nothing of exceptions, no type information. With
# PLANTED the source has a fault, and the list has to show it.
separate_arguments(FLAGS)
set(command ${COMPILER} -std=c++20 -fno-exceptions -fno-rtti)
foreach(folder ${INCLUDES})
  list(APPEND command -I${folder})
endforeach()
foreach(definition ${DEFINITIONS})
  list(APPEND command -D${definition})
endforeach()
execute_process(COMMAND ${command} ${FLAGS} -c ${SOURCE} -o ${OBJECT} RESULT_VARIABLE status
                ERROR_VARIABLE said)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${SOURCE} must compile without exceptions, but:\n${said}")
endif()
execute_process(COMMAND ${NM} --undefined-only --demangle ${OBJECT} OUTPUT_VARIABLE symbols
                COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL
             "[^\n]*(operator new|operator delete|alloc|[ _]free|__cxa|_Unwind|__gxx|typeinfo|throw)[^\n]*"
             found "${symbols}")
string(REPLACE ";" "\n" found "${found}")
if(PLANTED AND NOT found)
  message(FATAL_ERROR "the check is blind: it misses the fault in ${SOURCE}; it saw\n${symbols}")
elseif(found AND NOT PLANTED)
  message(FATAL_ERROR "${SOURCE} must not need\n${found}")
endif()
message(STATUS "${SOURCE} needs\n${symbols}")
