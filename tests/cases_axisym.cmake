# SPDX-License-Identifier: BSD-2-Clause
gaiter_unit_test(axisym_energy LABEL jacobian USES physics)

add_executable(axisym_reference axisym_reference.cpp session_main.cpp)
target_link_libraries(axisym_reference PRIVATE gaiter_solvers GTest::gtest)
foreach(RANKS 1 2 3)
  gaiter_add_test(axisym_reference_on_${RANKS} LABEL cross RANKS ${RANKS} TIMEOUT 300
                  COMMAND $<TARGET_FILE:axisym_reference>)
endforeach()

# On cylinders and cones, on one rank: gaiter_axisym_test(NAME LABEL convergence)
function(gaiter_axisym_test NAME)
  cmake_parse_arguments(ARG "" "LABEL" "" ${ARGN})
  add_executable(${NAME} ${NAME}.cpp session_main.cpp)
  target_link_libraries(${NAME} PRIVATE gaiter_solvers GTest::gtest)
  gaiter_add_test(${NAME} LABEL ${ARG_LABEL} TIMEOUT 120 COMMAND ${NAME})
endfunction()

gaiter_axisym_test(axisym_jacobian LABEL jacobian)
gaiter_axisym_test(axisym_locking LABEL convergence)
gaiter_axisym_test(axisym_convergence LABEL convergence)
gaiter_axisym_test(axisym_press_fit LABEL convergence)
gaiter_axisym_test(axisym_voltage LABEL cross)
gaiter_axisym_test(axisym_extremes LABEL cross)
gaiter_axisym_test(axisym_dual LABEL convergence)
gaiter_axisym_test(residual_estimate LABEL cross)

add_executable(axisym_fields axisym_fields.cpp session_main.cpp)
target_link_libraries(axisym_fields PRIVATE gaiter_solvers GTest::gtest)
foreach(RANKS 1 2 3)
  gaiter_add_test(axisym_fields_on_${RANKS} LABEL properties RANKS ${RANKS} TIMEOUT 120
                  COMMAND $<TARGET_FILE:axisym_fields>)
endforeach()

# The program, and VTK's reader of what it writes.
gaiter_program_test(axisym_view LABEL command_line)
set_tests_properties(axisym_view PROPERTIES PROCESSORS 2)

# On 1 to 3 ranks: on 3 and more, received entries of the tangent add up in any order.
add_executable(axisym_linear axisym_linear.cpp session_main.cpp)
target_link_libraries(axisym_linear PRIVATE gaiter_solvers GTest::gtest)
foreach(RANKS 1 2 3)
  gaiter_add_test(axisym_linear_on_${RANKS} LABEL properties RANKS ${RANKS} TIMEOUT 60
                  COMMAND $<TARGET_FILE:axisym_linear>)
endforeach()

add_executable(axisym_leg axisym_leg.cpp session_main.cpp)
target_link_libraries(axisym_leg PRIVATE gaiter_solvers GTest::gtest)
foreach(RANKS 1 2)
  gaiter_add_test(axisym_leg_on_${RANKS} LABEL cross RANKS ${RANKS} TIMEOUT 300
                  COMMAND $<TARGET_FILE:axisym_leg>)
endforeach()
find_package(LAPACK REQUIRED)
target_link_libraries(axisym_voltage PRIVATE LAPACK::LAPACK)
