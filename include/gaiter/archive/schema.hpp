// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gaiter/model/result.hpp"

namespace gaiter::archive {

// Raised whenever a reader of an older archive would misunderstand a newer one.
inline constexpr int schema_version = 1;

using Field = std::variant<double model::SegmentResult::*, int model::SegmentResult::*,
                           model::Status model::SegmentResult::*, model::Fidelity model::SegmentResult::*>;

// How a field lies in the file. Enumerations are int8 with the CF attributes flag_values and flag_meanings.
enum class Stored { float64, int64, int32, int8 };

// One variable over (case, segment): a field of model::SegmentResult under its own name.
struct Column {
  std::string_view name;
  std::string_view unit;  // udunits spelling, empty for enumerations
  std::string_view long_name;
  Field field;
  bool of_plan = false;  // known with -fidelity auto alone
};

// The whole table, in the order of the fields. Nothing else in the program lists the variables.
std::span<const Column> columns();

Stored stored_as(const Column& column);
std::size_t bytes_of(Stored stored);

// The columns of these names, in the table's order; `status` is always among them, for without it a NaN has
// no reason. No name: all columns. Throws base::InputError for a name that no column has.
std::vector<const Column*> choose_columns(std::span<const std::string> names);

// The words of the column's enumeration; word i belongs to the value i. Empty for numbers.
std::vector<std::string_view> flag_words(const Column& column);

std::string_view word(model::Status status);
std::string_view word(model::Fidelity fidelity);

// Copies the field of every row to `out`, which holds rows.size() values of the stored type.
void gather(const Column& column, std::span<const model::SegmentResult> rows, std::byte* out);

}  // namespace gaiter::archive
