// SPDX-License-Identifier: BSD-2-Clause
#pragma once

// What the tests of the archive share: groups of ranks, sample results, comparison, limits on the size of
// files.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <regex>
#include <sstream>

#include <mpi.h>

#include "gaiter/archive/chunk_file.hpp"
#include "gaiter/archive/durable_file.hpp"
#include "gaiter/archive/hdf5.hpp"
#include "gaiter/archive/provenance.hpp"
#include "gaiter/archive/reader.hpp"
#include "gaiter/archive/schema.hpp"
#include "gaiter/archive/sweep_archive.hpp"
#include "gaiter/base/error.hpp"

namespace gaiter::archive {

namespace fs = std::filesystem;
using model::SegmentResult;

inline int rank_in(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

inline int size_of(MPI_Comm comm) {
  int size = 1;
  MPI_Comm_size(comm, &size);
  return size;
}

// The first `size` ranks; null on the others.
class Group {
 public:
  explicit Group(int size) {
    const int rank = rank_in(MPI_COMM_WORLD);
    MPI_Comm_split(MPI_COMM_WORLD, rank < size ? 0 : MPI_UNDEFINED, rank, &comm_);
  }
  ~Group() {
    if (comm_ != MPI_COMM_NULL) {
      MPI_Comm_free(&comm_);
    }
  }
  Group(const Group&) = delete;
  Group& operator=(const Group&) = delete;
  MPI_Comm comm() const { return comm_; }

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
};

// Every value differs from every other and is exact in binary; every seventh row has diverged.
inline SegmentResult sample_row(std::size_t row) {
  const double x = static_cast<double>(row) + 0.25;
  SegmentResult result;
  result.pressure_rest = 1000 + x;
  result.pressure_actuated = 2000 + x;
  result.pressure_rest_rigid = 3000 + x;
  result.pressure_actuated_rigid = 4000 + x;
  result.pressure_rest_area_mean = 5000 + x;
  result.pressure_actuated_area_mean = 6000 + x;
  result.pressure_rest_change = 7000 + x;
  result.pressure_actuated_change = 8000 + x;
  result.actuation_drop = 9000 + x;
  result.actuation_pressure = 10000 + x;
  result.volume_initial = 11000 + x;
  result.volume_rest = 12000 + x;
  result.volume_actuated = 13000 + x;
  result.volume_change = 14000 + x;
  result.radius_actuated = 15000 + x;
  result.stretch_actual = 16000 + x;
  result.slip_max = 17000 + x;
  result.electric_field_max = 18000 + x;
  result.voltage_stable = 19000 + x;
  result.error_estimate = 20000 + x;
  result.discretisation_error = 21000 + x;
  result.model_error = 22000 + x;
  result.planned_discretisation_error = 23000 + x;
  result.planned_model_error = 24000 + x;
  result.planned_cost = 25000 + x;
  result.slice_count = static_cast<int>(200000 + row);
  result.wall_points = static_cast<int>(300000 + row);
  result.unknowns = static_cast<int>(400000 + row);
  result.iterations = static_cast<int>(100000 + row);
  result.status = static_cast<model::Status>(row % 7);
  result.fidelity = static_cast<model::Fidelity>(row % 2);
  if (result.status == model::Status::diverged) {
    result.pressure_rest = std::numeric_limits<double>::quiet_NaN();
  }
  return result;
}

inline std::vector<SegmentResult> sample_rows(std::size_t first, std::size_t end) {
  std::vector<SegmentResult> rows;
  for (std::size_t row = first; row < end; ++row) {
    rows.push_back(sample_row(row));
  }
  return rows;
}

inline std::vector<double> sample_times(std::size_t first, std::size_t end) {
  std::vector<double> seconds;
  for (std::size_t i = first; i < end; ++i) {
    seconds.push_back(0.5 + static_cast<double>(i));
  }
  return seconds;
}

inline Layout sample_layout(std::size_t cases,
                            std::vector<std::string> segments = {"r6", "r5", "mollet_été"}) {
  return {cases,
          std::move(segments),
          {{"bandage_stretch", "1", "stretch that the bandages are laid on with"},
           {"voltage", "V", "voltage on all bandages"}},
          {}};
}

inline std::vector<std::vector<double>> sample_swept(std::size_t first, std::size_t end) {
  std::vector<std::vector<double>> values(2);
  for (std::size_t i = first; i < end; ++i) {
    values[0].push_back(1.5 + 0.125 * static_cast<double>(i));
    values[1].push_back(1000 * static_cast<double>(i));
  }
  return values;
}

inline Provenance sample_provenance() {
  return {"0.1.0", "3.18.5", "voltage: 11.3 kV\n", "gaiter sweep -voltage '11.3 kV'", "2026-01-02T03:04:05Z",
          2};
}

inline void store_sample(SweepArchive& archive, std::size_t chunk, std::size_t segments) {
  const std::size_t first = archive.first_case(chunk);
  const std::size_t end = first + archive.cases_in(chunk);
  archive.store(chunk, sample_rows(first * segments, end * segments), sample_times(first, end),
                sample_swept(first, end));
  archive.flush();
}

// A whole run, or what an earlier one has left of it: chunks to ranks in turn, from the last to the first.
inline void write_sample(MPI_Comm comm, const std::string& path, const Layout& layout,
                         std::size_t chunk_cases) {
  SweepArchive archive(comm, path, layout, sample_provenance(), chunk_cases);
  for (std::size_t chunk = archive.chunks(); chunk-- > 0;) {
    const bool mine = static_cast<int>(chunk) % size_of(comm) == rank_in(comm);
    if (mine && !archive.finished(chunk)) {
      store_sample(archive, chunk, layout.segments.size());
    }
  }
  archive.finish();
}

// Bit by bit, so that NaN equals NaN and -0 does not equal 0.
inline void expect_same_bits(const std::vector<double>& got, const std::vector<double>& expected,
                             const std::string& what) {
  ASSERT_EQ(got.size(), expected.size()) << what;
  for (std::size_t i = 0; i < got.size(); ++i) {
    EXPECT_EQ(std::memcmp(&got[i], &expected[i], sizeof got[i]), 0)
        << what << "[" << i << "] is " << got[i] << ", expected " << expected[i];
  }
}

// Compares all variables over (case, segment) with what the rows hold; fields are named here once more, so
// that a wrong entry in the schema shows.
inline void expect_rows(const Archive& archive, const std::vector<SegmentResult>& rows) {
  const auto expect = [&](const std::string& name, auto member) {
    std::vector<double> expected;
    for (const SegmentResult& row : rows) {
      expected.push_back(static_cast<double>(row.*member));
    }
    expect_same_bits(archive.variables.at(name).numbers, expected, name);
  };
  expect("pressure_rest", &SegmentResult::pressure_rest);
  expect("pressure_actuated", &SegmentResult::pressure_actuated);
  expect("pressure_rest_rigid", &SegmentResult::pressure_rest_rigid);
  expect("pressure_actuated_rigid", &SegmentResult::pressure_actuated_rigid);
  expect("pressure_rest_area_mean", &SegmentResult::pressure_rest_area_mean);
  expect("pressure_actuated_area_mean", &SegmentResult::pressure_actuated_area_mean);
  expect("pressure_rest_change", &SegmentResult::pressure_rest_change);
  expect("pressure_actuated_change", &SegmentResult::pressure_actuated_change);
  expect("actuation_drop", &SegmentResult::actuation_drop);
  expect("actuation_pressure", &SegmentResult::actuation_pressure);
  expect("volume_initial", &SegmentResult::volume_initial);
  expect("volume_rest", &SegmentResult::volume_rest);
  expect("volume_actuated", &SegmentResult::volume_actuated);
  expect("volume_change", &SegmentResult::volume_change);
  expect("radius_actuated", &SegmentResult::radius_actuated);
  expect("stretch_actual", &SegmentResult::stretch_actual);
  expect("slip_max", &SegmentResult::slip_max);
  expect("electric_field_max", &SegmentResult::electric_field_max);
  expect("voltage_stable", &SegmentResult::voltage_stable);
  expect("error_estimate", &SegmentResult::error_estimate);
  expect("discretisation_error", &SegmentResult::discretisation_error);
  expect("model_error", &SegmentResult::model_error);
  expect("planned_discretisation_error", &SegmentResult::planned_discretisation_error);
  expect("planned_model_error", &SegmentResult::planned_model_error);
  expect("planned_cost", &SegmentResult::planned_cost);
  expect("slices_used", &SegmentResult::slice_count);
  expect("wall_points_used", &SegmentResult::wall_points);
  expect("unknowns", &SegmentResult::unknowns);
  expect("iterations", &SegmentResult::iterations);
  expect("status", &SegmentResult::status);
  expect("fidelity", &SegmentResult::fidelity);
}

inline void expect_same_variables(const Archive& got, const Archive& expected) {
  ASSERT_EQ(got.variables.size(), expected.variables.size());
  for (const auto& [name, variable] : expected.variables) {
    const Variable& other = got.variables.at(name);
    EXPECT_EQ(other.dimensions, variable.dimensions) << name;
    EXPECT_EQ(other.shape, variable.shape) << name;
    EXPECT_EQ(other.type, variable.type) << name;
    EXPECT_EQ(other.words, variable.words) << name;
    EXPECT_EQ(other.attributes, variable.attributes) << name;
    expect_same_bits(other.numbers, variable.numbers, name);
  }
}

inline std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// The message of what `work` throws; empty if it throws nothing.
template <class Error, class Work>
inline std::string message_of(Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// A file limit of this process, as a full disk would be; lifted again at the end. Beyond it the
// system ends the process unless it is told not to, which is left to the archive.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit before_{};
};

}  // namespace gaiter::archive
