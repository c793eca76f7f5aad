# SPDX-License-Identifier: BSD-2-Clause
gaiter_unit_test(axisym_energy LABEL jacobian USES physics)

add_executable(axisym_reference axisym_reference.cpp session_main.cpp)
target_link_libraries(axisym_reference PRIVATE gaiter_solvers GTest::gtest)
foreach(RANKS 1 2 3)
  gaiter_add_test(axisym_reference_on_${RANKS} LABEL cross RANKS ${RANKS} TIMEOUT 300
                  COMMAND $<TARGET_FILE:axisym_reference>)
endforeach()

# On 1 to 3 ranks: on 3 and more, received entries of the tangent add up in any order.
add_executable(axisym_linear axisym_linear.cpp session_main.cpp)
target_link_libraries(axisym_linear PRIVATE gaiter_solvers GTest::gtest)
foreach(RANKS 1 2 3)
  gaiter_add_test(axisym_linear_on_${RANKS} LABEL properties RANKS ${RANKS} TIMEOUT 60
                  COMMAND $<TARGET_FILE:axisym_linear>)
endforeach()
