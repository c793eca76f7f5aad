// SPDX-License-Identifier: BSD-2-Clause
// The archive on any number of ranks: what is read back. The sample written here is opened from Python by
// archive_opens.py.
#include "archive_samples.hpp"

namespace gaiter::archive {
namespace {

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
  EXPECT_EQ(word(model::Status::not_wanted), "not_wanted");
  EXPECT_EQ(word(model::Fidelity::rigid), "rigid");
  EXPECT_EQ(word(model::Fidelity::slice), "slice");
}

TEST(Schema, ChoosesColumnsInTheTablesOrderAndAlwaysTheStatus) {
  const auto names = [](const std::vector<std::string>& wanted) {
    std::vector<std::string> chosen;
    for (const Column* column : choose_columns(wanted)) {
      chosen.emplace_back(column->name);
    }
    return chosen;
  };
  EXPECT_EQ(names({}).size(), columns().size());
  EXPECT_EQ(names({"volume_rest", "pressure_rest"}),
            (std::vector<std::string>{"pressure_rest", "volume_rest", "status"}));
  EXPECT_EQ(names({"status"}), std::vector<std::string>{"status"});
  EXPECT_EQ(message_of<base::InputError>([&] { names({"presure_rest"}); }),
            "'presure_rest' is no variable of an archive; did you mean 'pressure_rest'?");
}

TEST(Archive, HoldsTheSameBytesOnAnyNumberOfRanksAndInChunksTheSameValues) {
  for (const std::size_t cases : {1u, 2u, 37u, 500u}) {
    const Layout layout = sample_layout(cases);
    for (const std::size_t chunk_cases : {1u, 7u, 100u, 1000u}) {
      if (cases > 40 * chunk_cases) {
        continue;
      }
      std::string on_one;
      for (int ranks = 1; ranks <= size_of(MPI_COMM_WORLD); ++ranks) {
        SCOPED_TRACE(std::to_string(cases) + " cases on " + std::to_string(ranks) + " ranks, " +
                     std::to_string(chunk_cases) + " a chunk");
        const Group group(ranks);
        if (group.comm() == MPI_COMM_NULL) {
          continue;
        }
        write_sample(group.comm(), "same_bytes.h5", layout, chunk_cases);
        if (rank_in(group.comm()) == 0) {
          const Archive archive = read_archive("same_bytes.h5");
          expect_rows(archive, sample_rows(0, layout.rows()));
          expect_same_bits(archive.variables.at("wall_time").numbers, sample_times(0, cases), "wall_time");
          expect_same_bits(archive.variables.at("voltage").numbers, sample_swept(0, cases)[1], "voltage");
          on_one = ranks == 1 ? content("same_bytes.h5") : on_one;
          EXPECT_TRUE(content("same_bytes.h5") == on_one);
          EXPECT_FALSE(fs::exists("same_bytes.h5.parts"));
          fs::remove("same_bytes.h5");
        }
        MPI_Barrier(group.comm());
      }
    }
  }
}

TEST(Archive, OfOneChunkIsWrittenAtOnce) {
  const Layout layout = sample_layout(37);
  const std::string path = "at_once_" + std::to_string(rank_in(MPI_COMM_WORLD)) + ".h5";
  std::ofstream(path) << "results of last week";
  write_archive(path, layout, sample_provenance(),
                {sample_rows(0, layout.rows()), sample_times(0, 37), sample_swept(0, 37)});
  expect_rows(read_archive(path), sample_rows(0, layout.rows()));
  EXPECT_EQ(message_of<base::InternalError>([&] {
              write_archive(path, layout, sample_provenance(),
                            {sample_rows(0, layout.rows() - 1), sample_times(0, 37), sample_swept(0, 37)});
            }),
            "-output " + path + ": 110 rows given, 111 expected");
  {
    const FileLimit limit(1000);
    EXPECT_EQ(message_of<base::InternalError>([&] {
                write_archive(path, layout, sample_provenance(),
                              {sample_rows(0, layout.rows()), sample_times(0, 37), sample_swept(0, 37)});
              }),
              "-output " + path + ": cannot write " + path + ": File too large");
  }
  expect_rows(read_archive(path), sample_rows(0, layout.rows()));
  for (const auto& entry : fs::directory_iterator(".")) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(path + ".")) << entry.path();
  }
  fs::remove(path);
}

TEST(Archive, KeepsOnlyTheColumnsAskedFor) {
  Layout layout = sample_layout(20);
  layout.columns = {"volume_rest"};
  write_sample(MPI_COMM_WORLD, "columns.h5", layout, 8);
  if (rank_in(MPI_COMM_WORLD) == 0) {
    std::vector<std::string> names;
    for (const auto& [name, variable] : read_archive("columns.h5").variables) {
      names.push_back(name);
    }
    EXPECT_EQ(names, (std::vector<std::string>{"bandage_stretch", "case", "segment", "status", "voltage",
                                               "volume_rest", "wall_time"}));
    fs::remove("columns.h5");
  }
}

TEST(Archive, TellsDimensionsUnitsFlagsAndProvenance) {
  Provenance provenance = sample_provenance();
  provenance.options = std::string(200000, 'x');  // beyond the 64 kB of a plain HDF5 attribute
  const std::string path = "tells_" + std::to_string(rank_in(MPI_COMM_WORLD)) + ".h5";
  write_archive(path, sample_layout(2), provenance,
                {sample_rows(0, 6), sample_times(0, 2), sample_swept(0, 2)});
  {
    const Archive archive = read_archive(path);
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
    EXPECT_EQ(fidelity.attributes.at("flag_values"), "0 1 2 3 4");
    EXPECT_EQ(fidelity.attributes.at("flag_meanings"), "rigid slice sliding axisym first_order");
    EXPECT_EQ(archive.variables.at("iterations").type, "int32");
    EXPECT_EQ(archive.attributes.at("options"), provenance.options);
    EXPECT_EQ(archive.attributes.at("schema_version"), "1");
    EXPECT_EQ(archive.attributes.at("ranks"), "2");
    EXPECT_EQ(archive.attributes.at("command"), provenance.command);
  }
  fs::remove(path);
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
  write_sample(MPI_COMM_WORLD, "printing.h5", sample_layout(1), 1);
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank_in(MPI_COMM_WORLD) == 0) {
    fs::remove("printing.h5");
  }
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
  if (rank_in(MPI_COMM_WORLD) == 0) {
    fs::remove("sample.h5");
  }
  write_sample(MPI_COMM_WORLD, "sample.h5", sample_layout(5), 2);
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
