# SPDX-License-Identifier: BSD-2-Clause
gaiter_slice_test(auto_model LABEL properties RANKS 1)
