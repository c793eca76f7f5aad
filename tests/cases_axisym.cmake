# SPDX-License-Identifier: BSD-2-Clause
gaiter_unit_test(axisym_energy LABEL jacobian USES physics)

add_executable(axisym_reference axisym_reference.cpp session_main.cpp)
target_link_libraries(axisym_reference PRIVATE gaiter_solvers GTest::gtest)
foreach(RANKS 1 2)
  gaiter_add_test(axisym_reference_on_${RANKS} LABEL cross RANKS ${RANKS} TIMEOUT 300
                  COMMAND $<TARGET_FILE:axisym_reference>)
endforeach()

add_executable(axisym_leg axisym_leg.cpp session_main.cpp)
target_link_libraries(axisym_leg PRIVATE gaiter_solvers GTest::gtest)
foreach(RANKS 1 2)
  gaiter_add_test(axisym_leg_on_${RANKS} LABEL cross RANKS ${RANKS} TIMEOUT 300
                  COMMAND $<TARGET_FILE:axisym_leg>)
endforeach()
