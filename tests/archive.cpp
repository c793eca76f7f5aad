// SPDX-License-Identifier: BSD-2-Clause
// The archive on any number of ranks: what is read back, what is left behind, and how failures show. The
// sample written here is opened from Python by archive_opens.py.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <regex>
#include <sstream>

#include <mpi.h>
#include "gaiter/archive/hdf5.hpp"
#include "gaiter/archive/provenance.hpp"
#include "gaiter/archive/reader.hpp"
#include "gaiter/archive/schema.hpp"
#include "gaiter/archive/writer.hpp"
#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

namespace fs = std::filesystem;
using model::SegmentResult;

int rank_in(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

int size_of(MPI_Comm comm) {
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
SegmentResult sample_row(std::size_t row) {
  const double x = static_cast<double>(row) + 0.25;
  SegmentResult result;
  result.pressure_rest = 1000 + x;
  result.pressure_actuated = 2000 + x;
  result.pressure_rest_rigid = 3000 + x;
  result.pressure_actuated_rigid = 4000 + x;
  result.pressure_rest_area_mean = 5000 + x;
  result.pressure_actuated_area_mean = 6000 + x;
  result.actuation_drop = 7000 + x;
  result.actuation_pressure = 8000 + x;
  result.volume_initial = 9000 + x;
  result.volume_rest = 10000 + x;
  result.volume_actuated = 11000 + x;
  result.volume_change = 12000 + x;
  result.radius_actuated = 13000 + x;
  result.stretch_actual = 14000 + x;
  result.slip_max = 15000 + x;
  result.electric_field_max = 16000 + x;
  result.error_estimate = 17000 + x;
  result.iterations = static_cast<int>(100000 + row);
  result.status = static_cast<model::Status>(row % 7);
  result.fidelity = static_cast<model::Fidelity>(row % 2);
  if (result.status == model::Status::diverged) {
    result.pressure_rest = std::numeric_limits<double>::quiet_NaN();
  }
  return result;
}

std::vector<SegmentResult> sample_rows(std::size_t first, std::size_t end) {
  std::vector<SegmentResult> rows;
  for (std::size_t row = first; row < end; ++row) {
    rows.push_back(sample_row(row));
  }
  return rows;
}

std::vector<double> sample_times(std::size_t first, std::size_t end) {
  std::vector<double> seconds;
  for (std::size_t i = first; i < end; ++i) {
    seconds.push_back(0.5 + static_cast<double>(i));
  }
  return seconds;
}

Layout sample_layout(std::size_t cases, std::vector<std::string> segments = {"r6", "r5", "mollet_été"}) {
  SweptVariable stretch{"bandage_stretch", "1", "stretch that the bandages are laid on with", {}};
  SweptVariable voltage{"voltage", "V", "voltage on all bandages", {}};
  for (std::size_t i = 0; i < cases; ++i) {
    stretch.values.push_back(1.5 + 0.125 * static_cast<double>(i));
    voltage.values.push_back(1000 * static_cast<double>(i));
  }
  return {cases, std::move(segments), {stretch, voltage}};
}

Provenance sample_provenance() {
  return {"0.1.0", "3.18.5", "voltage: 11.3 kV\n", "gaiter sweep -voltage '11.3 kV'", "2026-01-02T03:04:05Z",
          2};
}

// Cuts `count` into as many ranges as there are ranks, regardless of where a case ends.
std::pair<std::size_t, std::size_t> my_range(MPI_Comm comm, std::size_t count) {
  const auto rank = static_cast<std::size_t>(rank_in(comm));
  const auto ranks = static_cast<std::size_t>(size_of(comm));
  return {count * rank / ranks, count * (rank + 1) / ranks};
}

void write_sample(MPI_Comm comm, const std::string& path, const Layout& layout) {
  Writer writer(comm, path, layout, sample_provenance());
  const auto [first, end] = my_range(comm, layout.rows());
  writer.write(first, sample_rows(first, end));
  const auto [first_case, end_case] = my_range(comm, layout.cases);
  writer.write_wall_times(first_case, sample_times(first_case, end_case));
  writer.close();
}

// Bit by bit, so that NaN equals NaN and -0 does not equal 0.
void expect_same_bits(const std::vector<double>& got, const std::vector<double>& expected,
                      const std::string& what) {
  ASSERT_EQ(got.size(), expected.size()) << what;
  for (std::size_t i = 0; i < got.size(); ++i) {
    EXPECT_EQ(std::memcmp(&got[i], &expected[i], sizeof got[i]), 0)
        << what << "[" << i << "] is " << got[i] << ", expected " << expected[i];
  }
}

// Compares all variables over (case, segment) with what the rows hold; fields are named here once more, so
// that a wrong entry in the schema shows.
void expect_rows(const Archive& archive, const std::vector<SegmentResult>& rows) {
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
  expect("error_estimate", &SegmentResult::error_estimate);
  expect("iterations", &SegmentResult::iterations);
  expect("status", &SegmentResult::status);
  expect("fidelity", &SegmentResult::fidelity);
}

void expect_same_variables(const Archive& got, const Archive& expected) {
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

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// The message of what `work` throws; empty if it throws nothing.
template <class Error, class Work>
std::string message_of(Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// A file limit of this process, as a full disk would be; lifted again at the end.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) {
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = SIG_DFL;
};

// The columns lie one after the other in a result, without a gap that another field would fill.
TEST(Schema, HoldsEveryFieldOfAResult) {
  const SegmentResult row;
  std::size_t end = 0;
  for (const Column& column : columns()) {
    std::visit(
        [&](auto member) {
          const std::size_t alignment = alignof(decltype(row.*member));
          const auto* address = reinterpret_cast<const char*>(&(row.*member));
          end = (end + alignment - 1) / alignment * alignment;
          EXPECT_EQ(address - reinterpret_cast<const char*>(&row), static_cast<std::ptrdiff_t>(end))
              << column.name;
          end += sizeof(row.*member);
        },
        column.field);
  }
  const std::size_t alignment = alignof(SegmentResult);
  EXPECT_EQ((end + alignment - 1) / alignment * alignment, sizeof(SegmentResult));
}

TEST(Schema, NamesAreDistinctAndEveryNumberHasAUnit) {
  std::vector<std::string_view> names;
  for (const Column& column : columns()) {
    names.push_back(column.name);
    EXPECT_EQ(column.unit.empty(), !flag_words(column).empty()) << column.name;
    EXPECT_GT(column.long_name.size(), 20u) << column.name;
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

TEST(Schema, WordsAreThoseOfTheEnumerations) {
  EXPECT_EQ(word(model::Status::contact), "contact");
  EXPECT_EQ(word(model::Status::slack), "slack");
  EXPECT_EQ(word(model::Status::lifted), "lifted");
  EXPECT_EQ(word(model::Status::extrapolated), "extrapolated");
  EXPECT_EQ(word(model::Status::pulled_in), "pulled_in");
  EXPECT_EQ(word(model::Status::no_equilibrium), "no_equilibrium");
  EXPECT_EQ(word(model::Status::diverged), "diverged");
  EXPECT_EQ(word(model::Fidelity::rigid), "rigid");
  EXPECT_EQ(word(model::Fidelity::slice), "slice");
}

TEST(Archive, HoldsTheSameBitsOnAnyNumberOfRanks) {
  for (const std::size_t cases : {1u, 2u, 37u, 500u}) {
    const Layout layout = sample_layout(cases);
    std::unique_ptr<Archive> on_one;
    for (int ranks = 1; ranks <= size_of(MPI_COMM_WORLD); ++ranks) {
      SCOPED_TRACE(std::to_string(cases) + " cases on " + std::to_string(ranks) + " ranks");
      const Group group(ranks);
      if (group.comm() == MPI_COMM_NULL) {
        continue;
      }
      write_sample(group.comm(), "same_bits.h5", layout);
      if (rank_in(group.comm()) == 0) {
        const Archive archive = read_archive("same_bits.h5");
        expect_rows(archive, sample_rows(0, layout.rows()));
        expect_same_bits(archive.variables.at("wall_time").numbers, sample_times(0, cases), "wall_time");
        expect_same_bits(archive.variables.at("voltage").numbers, layout.swept[1].values, "voltage");
        if (!on_one) {
          on_one = std::make_unique<Archive>(archive);
        }
        expect_same_variables(archive, *on_one);
        EXPECT_EQ(archive.attributes, on_one->attributes);
      }
    }
  }
}

// Three ranges cut at every pair of places, taken by the ranks in turn: cases are cut in the middle, ranges
// lie within one case or are empty, and with fewer than three ranks a Writer is written to several times.
TEST(Archive, TakesRangesCutAnywhere) {
  const Layout layout = sample_layout(3, {"r2", "r1"});
  const auto ranks = static_cast<std::size_t>(size_of(MPI_COMM_WORLD));
  const auto rank = static_cast<std::size_t>(rank_in(MPI_COMM_WORLD));
  for (std::size_t a = 0; a <= layout.rows(); ++a) {
    for (std::size_t b = a; b <= layout.rows(); ++b) {
      SCOPED_TRACE("cut at " + std::to_string(a) + " and " + std::to_string(b));
      const std::size_t cuts[] = {0, a, b, layout.rows()};
      Writer writer(MPI_COMM_WORLD, "cut_anywhere.h5", layout, sample_provenance());
      for (std::size_t part = rank; part < 3 + rank; part += ranks) {
        const bool empty = part >= 3;
        const std::size_t first = empty ? 0 : cuts[part];
        writer.write(first, sample_rows(first, empty ? 0 : cuts[part + 1]));
      }
      writer.close();
      if (rank == 0) {
        expect_rows(read_archive("cut_anywhere.h5"), sample_rows(0, layout.rows()));
      }
    }
  }
}

TEST(Archive, RowsNotWrittenHoldTheFillValue) {
  const Layout layout = sample_layout(2, {"r2", "r1"});
  Writer writer(MPI_COMM_WORLD, "fill.h5", layout, sample_provenance());
  const bool mine = rank_in(MPI_COMM_WORLD) == 0;
  writer.write(1, sample_rows(1, mine ? 2 : 1));
  writer.close();
  if (mine) {
    const Archive archive = read_archive("fill.h5");
    const auto& pressure = archive.variables.at("pressure_actuated").numbers;
    EXPECT_TRUE(std::isnan(pressure.at(0)));
    EXPECT_EQ(pressure.at(1), 2001.25);
    EXPECT_TRUE(std::isnan(pressure.at(2)));
    EXPECT_EQ(archive.variables.at("status").numbers, (std::vector<double>{-1, 1, -1, -1}));
    EXPECT_EQ(archive.variables.at("iterations").numbers, (std::vector<double>{-1, 100001, -1, -1}));
    EXPECT_TRUE(std::isnan(archive.variables.at("wall_time").numbers.at(0)));
  }
}

TEST(Archive, TellsDimensionsUnitsFlagsAndProvenance) {
  Provenance provenance = sample_provenance();
  provenance.options = std::string(200000, 'x');  // beyond the 64 kB of a plain HDF5 attribute
  Writer writer(MPI_COMM_WORLD, "tells.h5", sample_layout(2), provenance);
  writer.close();
  if (rank_in(MPI_COMM_WORLD) == 0) {
    const Archive archive = read_archive("tells.h5");
    const Variable& pressure = archive.variables.at("pressure_rest");
    EXPECT_EQ(pressure.dimensions, (std::vector<std::string>{"case", "segment"}));
    EXPECT_EQ(pressure.shape, (std::vector<std::size_t>{2, 3}));
    EXPECT_EQ(pressure.type, "float64");
    EXPECT_EQ(pressure.attributes.at("units"), "Pa");
    EXPECT_EQ(archive.variables.at("case").type, "int64");
    EXPECT_EQ(archive.variables.at("case").numbers, (std::vector<double>{0, 1}));
    EXPECT_EQ(archive.variables.at("segment").words, (std::vector<std::string>{"r6", "r5", "mollet_été"}));
    EXPECT_EQ(archive.variables.at("voltage").dimensions, (std::vector<std::string>{"case"}));
    EXPECT_EQ(archive.variables.at("voltage").attributes.at("units"), "V");
    const Variable& fidelity = archive.variables.at("fidelity");
    EXPECT_EQ(fidelity.type, "int8");
    EXPECT_EQ(fidelity.attributes.at("flag_values"), "0 1 2 3");
    EXPECT_EQ(fidelity.attributes.at("flag_meanings"), "rigid slice sliding axisym");
    EXPECT_EQ(archive.variables.at("iterations").type, "int32");
    EXPECT_EQ(archive.attributes.at("options"), provenance.options);
    EXPECT_EQ(archive.attributes.at("schema_version"), "1");
    EXPECT_EQ(archive.attributes.at("ranks"), "2");
    EXPECT_EQ(archive.attributes.at("command"), provenance.command);
  }
}

TEST(Writer, AbandonedLeavesNothing) {
  const Layout layout = sample_layout(4);
  {
    Writer writer(MPI_COMM_WORLD, "abandoned.h5", layout, sample_provenance());
    if (rank_in(MPI_COMM_WORLD) == 0) {
      EXPECT_TRUE(fs::exists("abandoned.h5.part"));
    }
    const auto [first, end] = my_range(MPI_COMM_WORLD, layout.rows());
    writer.write(first, sample_rows(first, end));
  }
  EXPECT_FALSE(fs::exists("abandoned.h5"));
  EXPECT_FALSE(fs::exists("abandoned.h5.part"));
}

TEST(Writer, ReplacesAnExistingFileOnlyWhenFinished) {
  const bool first_rank = rank_in(MPI_COMM_WORLD) == 0;
  if (first_rank) {
    std::ofstream("existing.h5") << "results of last week";
  }
  const Layout layout = sample_layout(1);
  { Writer abandoned(MPI_COMM_WORLD, "existing.h5", layout, sample_provenance()); }
  if (first_rank) {
    EXPECT_EQ(content("existing.h5"), "results of last week");
  }
  write_sample(MPI_COMM_WORLD, "existing.h5", layout);
  if (first_rank) {
    expect_rows(read_archive("existing.h5"), sample_rows(0, layout.rows()));
    EXPECT_FALSE(fs::exists("existing.h5.part"));
  }
}

TEST(Writer, FailureOfOneRankIsThrownOnAllAndDoesNotSpoilTheFile) {
  const Layout layout = sample_layout(4);
  const int last = size_of(MPI_COMM_WORLD) - 1;
  Writer writer(MPI_COMM_WORLD, "one_fails.h5", layout, sample_provenance());
  const auto [first, end] = my_range(MPI_COMM_WORLD, layout.rows());
  const std::size_t beyond = rank_in(MPI_COMM_WORLD) == last ? layout.rows() - 1 : 0;
  EXPECT_EQ(
      message_of<base::InternalError>([&] { writer.write(beyond, sample_rows(0, beyond > 0 ? 2 : 0)); }),
      "archive one_fails.h5: rows 11 to 13 given, it has only 12");
  writer.write(first, sample_rows(first, end));
  writer.close();
  EXPECT_EQ(message_of<base::InternalError>([&] { writer.close(); }),
            "archive one_fails.h5: it is closed already");
  if (rank_in(MPI_COMM_WORLD) == 0) {
    expect_rows(read_archive("one_fails.h5"), sample_rows(0, layout.rows()));
  }
}

TEST(Writer, TellsTheCauseThatHdf5Gives) {
  Writer writer(MPI_COMM_WORLD, "vanishes.h5", sample_layout(1), sample_provenance());
  MPI_Barrier(MPI_COMM_WORLD);
  fs::remove("vanishes.h5.part");
  MPI_Barrier(MPI_COMM_WORLD);
  const std::string message = message_of<base::InternalError>([&] { writer.write(0, {}); });
  EXPECT_NE(message.find("archive vanishes.h5: cannot open vanishes.h5.part: "), std::string::npos)
      << message;
  EXPECT_EQ(message.find("gives no reason"), std::string::npos) << message;
  EXPECT_NE(message_of<base::InternalError>([&] { writer.close(); }).find("No such file"), std::string::npos);
}

TEST(Writer, FullDiskShowsBeforeTheWorkOnAllRanksAndLeavesNothing) {
  const Layout layout = sample_layout(20000);
  std::string message;
  {
    const FileLimit limit(1000000);
    message = message_of<base::InternalError>(
        [&] { Writer(MPI_COMM_WORLD, "full.h5", layout, sample_provenance()); });
  }
  EXPECT_TRUE(std::regex_match(
      message, std::regex("archive full.h5: cannot make room for [0-9]+ bytes: File too large")))
      << message;
  EXPECT_FALSE(fs::exists("full.h5"));
  EXPECT_FALSE(fs::exists("full.h5.part"));
}

TEST(Writer, WhenOneRankCannotWriteAllRanksThrow) {
  const Layout layout = sample_layout(20000);
  const bool last = rank_in(MPI_COMM_WORLD) == size_of(MPI_COMM_WORLD) - 1;
  std::string message;
  {
    Writer writer(MPI_COMM_WORLD, "stops.h5", layout, sample_provenance());
    const auto [first, end] = my_range(MPI_COMM_WORLD, layout.rows());
    const std::vector<SegmentResult> rows = sample_rows(first, end);
    const auto limit = last ? std::make_unique<FileLimit>(1000000) : nullptr;
    message = message_of<base::InternalError>([&, first = first] { writer.write(first, rows); });
  }
  EXPECT_EQ(message.find("archive stops.h5: cannot write variable "), 0u) << message;
  EXPECT_FALSE(fs::exists("stops.h5"));
  EXPECT_FALSE(fs::exists("stops.h5.part"));
}

TEST(Writer, RefusesALayoutThatDoesNotFit) {
  Layout layout = sample_layout(3);
  layout.swept[0].values.pop_back();
  EXPECT_EQ(message_of<base::InternalError>(
                [&] { Writer(MPI_COMM_WORLD, "layout.h5", layout, sample_provenance()); }),
            "archive layout.h5: bandage_stretch has 2 values for 3 cases");
  EXPECT_EQ(message_of<base::InternalError>(
                [&] { Writer(MPI_COMM_WORLD, "layout.h5", sample_layout(0), sample_provenance()); }),
            "archive layout.h5: it would hold no result");
  EXPECT_FALSE(fs::exists("layout.h5.part"));
}

TEST(CheckWritable, TakesWhatCanBeWrittenAndLeavesNoTrace) {
  const fs::path folder = "writable_" + std::to_string(rank_in(MPI_COMM_WORLD));
  fs::create_directories(folder);
  check_writable((folder / "new.h5").string());
  EXPECT_TRUE(fs::is_empty(folder));
  std::ofstream(folder / "old.h5") << "old";
  check_writable((folder / "old.h5").string());
  EXPECT_EQ(content((folder / "old.h5").string()), "old");
  check_writable("here.h5");
  fs::remove_all(folder);
}

TEST(CheckWritable, NamesValueAndReason) {
  const std::string folder = "folder_" + std::to_string(rank_in(MPI_COMM_WORLD)) + ".h5";
  fs::create_directories(folder);
  const auto refusal = [](const std::string& path) {
    return message_of<base::InputError>([&] { check_writable(path); });
  };
  EXPECT_EQ(refusal("no/such/paper.h5"), "-output no/such/paper.h5: the folder no/such does not exist");
  EXPECT_EQ(refusal("paper.nc"), "-output paper.nc: the name of an archive ends in .h5");
  EXPECT_EQ(refusal(".h5"), "-output .h5: the name of an archive ends in .h5");
  EXPECT_EQ(refusal(""), "-output : the name of an archive ends in .h5");
  EXPECT_EQ(refusal(folder),
            "-output " + folder + ": this is a folder; give the name of a file that ends in .h5");
  // Root may write to every ordinary folder, but no one can make a file here.
  EXPECT_EQ(
      refusal("/proc/paper.h5").find("-output /proc/paper.h5: no file can be made in the folder /proc: "),
      0u);
  EXPECT_NE(refusal(std::string(300, 'x') + ".h5").find("File name too long"), std::string::npos);
  fs::remove(folder);
}

TEST(Reader, NamesTheFileItCannotOpen) {
  const std::string text = "text_" + std::to_string(rank_in(MPI_COMM_WORLD)) + ".h5";
  std::ofstream(text) << "no archive";
  EXPECT_EQ(message_of<base::InputError>([&] {
              read_archive("missing.h5");
            }).find("archive missing.h5 cannot be opened: "),
            0u);
  EXPECT_EQ(message_of<base::InputError>([&] { read_archive(text); }).find("archive " + text), 0u);
  fs::remove(text);
}

TEST(Hdf5, AnIdHoldsOneReferenceAndMoves) {
  Id first(H5Screate(H5S_SCALAR));
  const hid_t id = first.get();
  EXPECT_EQ(H5Iget_ref(id), 1);
  Id second(std::move(first));
  EXPECT_EQ(first.get(), H5I_INVALID_HID);
  EXPECT_EQ(second.get(), id);
  EXPECT_EQ(H5Iget_ref(id), 1);
  Id third(H5Screate(H5S_SCALAR));
  const hid_t replaced = third.get();
  third = std::move(second);
  EXPECT_GT(H5Iis_valid(id), 0);
  EXPECT_EQ(H5Iis_valid(replaced), 0);
  EXPECT_TRUE(third.reset());
  EXPECT_EQ(H5Iis_valid(id), 0);
}

TEST(Hdf5, ErrorPrintingIsAsBeforeAfterwards) {
  const auto printer = [] {
    H5E_auto2_t function = nullptr;
    void* data = nullptr;
    H5Eget_auto2(H5E_DEFAULT, &function, &data);
    return function;
  };
  const H5E_auto2_t before = printer();
  ASSERT_NE(before, nullptr);
  {
    const QuietErrors quiet;
    EXPECT_EQ(printer(), nullptr);
  }
  EXPECT_EQ(printer(), before);
  write_sample(MPI_COMM_WORLD, "printing.h5", sample_layout(1));
  EXPECT_EQ(printer(), before);
}

TEST(Provenance, DescribesTheRun) {
  const Provenance run = describe_run(MPI_COMM_WORLD, "0.1.0", "voltage: 0\n", "gaiter solve");
  EXPECT_TRUE(std::regex_match(run.petsc_version, std::regex(R"(3\.\d+\.\d+( \(development\))?)")));
  EXPECT_TRUE(std::regex_match(run.created, std::regex(R"(20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ)")));
  EXPECT_EQ(run.ranks, size_of(MPI_COMM_WORLD));
  EXPECT_EQ(run.options, "voltage: 0\n");
  EXPECT_EQ(run.command, "gaiter solve");
}

TEST(Sample, IsWrittenForPython) {
  write_sample(MPI_COMM_WORLD, "sample.h5", sample_layout(5));
}

// On the other ranks than the first only failures are printed, with the rank.
class FailuresOnly : public testing::EmptyTestEventListener {
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (result.failed()) {
      std::printf("rank %d, %s:%d: %s\n", rank_in(MPI_COMM_WORLD), result.file_name(), result.line_number(),
                  result.message());
    }
  }
};

}  // namespace
}  // namespace gaiter::archive

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  testing::InitGoogleTest(&argc, argv);
  if (gaiter::archive::rank_in(MPI_COMM_WORLD) != 0) {
    auto& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new gaiter::archive::FailuresOnly);
  }
  const int failed = RUN_ALL_TESTS();
  MPI_Finalize();
  return failed;
}
