// SPDX-License-Identifier: BSD-2-Clause
// Writing archives on any number of ranks: what is left behind, and how failures show.
#include "archive_samples.hpp"

namespace gaiter::archive {
namespace {

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
  EXPECT_EQ(refusal("paper.nc"), "-output paper.nc: the name must end in .h5");
  EXPECT_EQ(refusal(".h5"), "-output .h5: the name must end in .h5");
  EXPECT_EQ(refusal(""), "-output : the name must end in .h5");
  EXPECT_EQ(refusal(folder),
            "-output " + folder + ": this is a folder; give the name of a file that ends in .h5");
  // Root may write to every ordinary folder, but no one can make a file here.
  EXPECT_EQ(
      refusal("/proc/paper.h5").find("-output /proc/paper.h5: no file can be made in the folder /proc: "),
      0u);
  EXPECT_NE(refusal(std::string(300, 'x') + ".h5").find("File name too long"), std::string::npos);
  fs::remove(folder);
}

}  // namespace
}  // namespace gaiter::archive
