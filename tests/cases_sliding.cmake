# SPDX-License-Identifier: BSD-2-Clause
gaiter_unit_test(sliding_jacobian LABEL jacobian TIMEOUT 120 USES physics)

# With PETSc, on several numbers of ranks: gaiter_sliding_test(NAME LABEL properties RANKS 1 2 3)
function(gaiter_sliding_test NAME)
  cmake_parse_arguments(ARG "" "LABEL" "RANKS" ${ARGN})
  add_executable(${NAME} ${NAME}.cpp session_main.cpp)
  target_link_libraries(${NAME} PRIVATE gaiter_solvers GTest::gtest)
  foreach(RANKS IN LISTS ARG_RANKS)
    gaiter_add_test(${NAME}_on_${RANKS} LABEL ${ARG_LABEL} RANKS ${RANKS} TIMEOUT 300
                    COMMAND $<TARGET_FILE:${NAME}>)
  endforeach()
endfunction()

gaiter_sliding_test(sliding_reference LABEL cross RANKS 1)
gaiter_sliding_test(sliding_profile LABEL properties RANKS 1)
gaiter_sliding_test(sliding_convergence LABEL convergence RANKS 1)
gaiter_sliding_test(sliding_status LABEL properties RANKS 1)
gaiter_sliding_test(sliding_ranks LABEL properties RANKS 1 2 3)

# The same answers by PETSc's own line search and trust region, and through the tangent's products.
gaiter_add_test(sliding_reference_line_search LABEL cross TIMEOUT 300
                COMMAND sliding_reference -sliding_snes_linesearch_type bt)
gaiter_add_test(sliding_reference_trust_region LABEL cross TIMEOUT 300
                COMMAND sliding_reference -sliding_snes_type newtontr)
gaiter_add_test(sliding_reference_krylov LABEL cross TIMEOUT 300
                COMMAND sliding_reference -sliding_ksp_type gmres -sliding_ksp_rtol 1e-10)

# The estimate of what slices leave out, against finite elements.
gaiter_sliding_test(model_shifts LABEL cross RANKS 1)
target_link_libraries(model_shifts PRIVATE Boost::headers)
