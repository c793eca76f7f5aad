# SPDX-License-Identifier: BSD-2-Clause

# gaiter_program_test(NAME LABEL command_line): tests/NAME.py runs the built program, alone and under mpiexec.
function(gaiter_program_test NAME)
  cmake_parse_arguments(ARG "" "LABEL" "" ${ARGN})
  gaiter_add_test(${NAME} LABEL ${ARG_LABEL} TIMEOUT 600
                  COMMAND ${GAITER_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/${NAME}.py $<TARGET_FILE:gaiter>
                          ${MPIEXEC_EXECUTABLE} ${PROJECT_SOURCE_DIR})
endfunction()

gaiter_program_test(command_line LABEL command_line)
gaiter_program_test(wrong_input LABEL command_line)
gaiter_program_test(axisym_solvers LABEL command_line)
set_tests_properties(axisym_solvers PROPERTIES PROCESSORS 2)
gaiter_program_test(same_archive LABEL properties)
set_tests_properties(same_archive PROPERTIES PROCESSORS 3)
gaiter_program_test(sweep_runs LABEL properties)
set_tests_properties(sweep_runs PROPERTIES PROCESSORS 2)
gaiter_program_test(readme LABEL command_line)
gaiter_program_test(report LABEL command_line)
gaiter_program_test(tradeoff LABEL properties)
set_tests_properties(tradeoff PROPERTIES PROCESSORS 2)
gaiter_add_test(architecture LABEL architecture
                COMMAND ${GAITER_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/architecture.py $<TARGET_FILE:gaiter>
                        ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR} ${CMAKE_CTEST_COMMAND})

# Random command lines; by hand `build/bin/fuzz --scenes 30000`.
add_executable(fuzz fuzz.cpp)
target_link_libraries(fuzz PRIVATE gaiter_studies Boost::headers)
gaiter_add_test(fuzz LABEL command_line TIMEOUT 600 COMMAND $<TARGET_FILE:fuzz> --scenes 600)
gaiter_add_test(fuzz_processes LABEL command_line TIMEOUT 300 COMMAND $<TARGET_FILE:fuzz> --scenes 25 --seed 5
                --program $<TARGET_FILE:gaiter>)
