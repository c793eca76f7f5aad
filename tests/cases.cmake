# SPDX-License-Identifier: BSD-2-Clause
include(cases_options.cmake OPTIONAL)
include(cases_archive.cmake OPTIONAL)
include(cases_slices.cmake OPTIONAL)
include(cases_command_line.cmake OPTIONAL)
include(cases_sliding.cmake OPTIONAL)
include(cases_axisym.cmake OPTIONAL)
include(cases_auto.cmake OPTIONAL)
