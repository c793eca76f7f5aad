# SPDX-License-Identifier: BSD-2-Clause
add_executable(archive archive.cpp archive_sweep.cpp)
target_link_libraries(archive PRIVATE gaiter_archive GTest::gtest)

# Each number of ranks works in a folder of its own and leaves the same sample.h5 there.
set(SAMPLES)
foreach(RANKS 1 2 3)
  set(FOLDER ${CMAKE_CURRENT_BINARY_DIR}/archive_on_${RANKS})
  file(MAKE_DIRECTORY ${FOLDER})
  list(APPEND SAMPLES ${FOLDER}/sample.h5)
  gaiter_add_test(archive_on_${RANKS} LABEL unit RANKS ${RANKS} COMMAND $<TARGET_FILE:archive>)
  set_tests_properties(archive_on_${RANKS} PROPERTIES WORKING_DIRECTORY ${FOLDER} FIXTURES_SETUP archive_samples)
endforeach()
gaiter_add_test(archive_opens LABEL unit
                COMMAND ${GAITER_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/archive_opens.py ${SAMPLES})
set_tests_properties(archive_opens PROPERTIES FIXTURES_REQUIRED archive_samples)

add_executable(archive_run archive_run.cpp)
target_link_libraries(archive_run PRIVATE gaiter_archive GTest::gtest)
gaiter_add_test(archive_kills LABEL properties RANKS 1 TIMEOUT 600
                COMMAND ${GAITER_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/archive_kills.py $<TARGET_FILE:archive_run>
                        ${MPIEXEC_EXECUTABLE})
set_tests_properties(archive_kills PROPERTIES PROCESSORS 3)

gaiter_unit_test(archive_compression LABEL unit USES archive)
