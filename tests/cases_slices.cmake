# SPDX-License-Identifier: BSD-2-Clause
find_package(Boost REQUIRED)

# Physics alone.
foreach(NAME slice_laws slice_jacobian)
  gaiter_unit_test(${NAME} LABEL unit TIMEOUT 300 USES physics)
  target_link_libraries(${NAME} PRIVATE Boost::headers)
endforeach()
set_tests_properties(slice_jacobian PROPERTIES LABELS jacobian)

# With PETSc: gaiter_slice_test(NAME LABEL properties RANKS 1 2 3)
function(gaiter_slice_test NAME)
  cmake_parse_arguments(ARG "" "LABEL" "RANKS" ${ARGN})
  add_executable(${NAME} ${NAME}.cpp session_main.cpp)
  target_link_libraries(${NAME} PRIVATE gaiter_solvers GTest::gtest Boost::headers)
  foreach(RANKS IN LISTS ARG_RANKS)
    gaiter_add_test(${NAME}_on_${RANKS} LABEL ${ARG_LABEL} RANKS ${RANKS} TIMEOUT 300
                    COMMAND $<TARGET_FILE:${NAME}>)
  endforeach()
endfunction()

gaiter_slice_test(slice_reference LABEL properties RANKS 1 2 3)
gaiter_slice_test(slice_newton LABEL properties RANKS 1 2 3)
gaiter_slice_test(slice_extremes LABEL properties RANKS 1)
gaiter_slice_test(slice_branches LABEL properties RANKS 1)
gaiter_slice_test(slice_precision LABEL properties RANKS 1)
gaiter_slice_test(extremes LABEL properties RANKS 1)
target_link_libraries(extremes PRIVATE gaiter_studies)
# The Jacobian by differences, without further options.
gaiter_add_test(slice_reference_by_differences LABEL jacobian TIMEOUT 300
                COMMAND $<TARGET_FILE:slice_reference> --gtest_filter=PaperTable.* -slice_snes_fd)
