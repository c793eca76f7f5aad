// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <string>

namespace gaiter::studies {

std::string help_text();      // commands, then every option with unit, default, range and meaning
std::string help_markdown();  // the options as the table of the README

}  // namespace gaiter::studies
