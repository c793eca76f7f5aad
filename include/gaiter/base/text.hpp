// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gaiter::base {

std::string_view trim(std::string_view text);  // without blanks at both ends
std::string lower(std::string_view text);      // ASCII letters only

// The trimmed pieces between separators; an empty text is one empty piece.
std::vector<std::string_view> split(std::string_view text, char separator = ',');

// How many letters have to be inserted, removed, replaced, or swapped with a neighbour, to make `a` of `b`.
std::size_t edit_distance(std::string_view a, std::string_view b);

// The candidate fewest edits away from `word`, the first of equals. Empty where none is near enough to be
// what was meant: more than a third of the word's letters would have to change.
std::string nearest(std::string_view word, std::span<const std::string> candidates);

}  // namespace gaiter::base
