# SPDX-License-Identifier: BSD-2-Clause
gaiter_unit_test(units LABEL unit USES base)
gaiter_unit_test(options LABEL unit USES studies)
gaiter_unit_test(designs LABEL unit USES studies)
gaiter_unit_test(sampling LABEL unit USES studies)
