// SPDX-License-Identifier: BSD-2-Clause
// The archive of a sweep on any number of ranks: what an unfinished one shows, how it is taken up, what is
// refused, and how failures show.
#include <functional>

#include "archive_samples.hpp"

namespace gaiter::archive {
namespace {

constexpr std::size_t chunk_cases = 4;

std::string refusal(const std::string& path, const Layout& layout, const Provenance& provenance,
                    std::size_t chunk = chunk_cases) {
  return message_of<base::InputError>([&] { SweepArchive(MPI_COMM_WORLD, path, layout, provenance, chunk); });
}

bool on_first_rank() {
  return rank_in(MPI_COMM_WORLD) == 0;
}

// On the first rank, while the others wait.
template <class Work>
void alone(Work&& work) {
  MPI_Barrier(MPI_COMM_WORLD);
  if (on_first_rank()) {
    work();
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

void clear(const std::string& path) {
  alone([&] {
    fs::remove(path);
    fs::remove_all(path + ".parts");
  });
}

// Ten cases in chunks 0 1 2 (3), of which 0 and 2 are stored, by the last rank.
void leave_unfinished(const std::string& path, const Layout& layout) {
  clear(path);
  SweepArchive archive(MPI_COMM_WORLD, path, layout, sample_provenance(), chunk_cases);
  EXPECT_FALSE(archive.complete());
  EXPECT_EQ(archive.chunks(), 3u);
  EXPECT_EQ(archive.cases_in(1), 4u);
  EXPECT_EQ(archive.first_case(2), 8u);
  EXPECT_EQ(archive.cases_in(2), 2u);
  for (const std::size_t chunk : {2, 0}) {
    EXPECT_FALSE(archive.finished(chunk));
    if (rank_in(MPI_COMM_WORLD) == size_of(MPI_COMM_WORLD) - 1) {
      store_sample(archive, chunk, layout.segments.size());
    }
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

std::vector<bool> finished_chunks(const std::string& path, const Layout& layout) {
  const SweepArchive archive(MPI_COMM_WORLD, path, layout, sample_provenance(), chunk_cases);
  std::vector<bool> finished;
  for (std::size_t i = 0; i < archive.chunks(); ++i) {
    finished.push_back(archive.finished(i));
  }
  return finished;
}

void expect_finishes(const std::string& path, const Layout& layout) {
  write_sample(MPI_COMM_WORLD, path, layout, chunk_cases);
  write_sample(MPI_COMM_WORLD, "undisturbed.h5", layout, chunk_cases);
  alone([&] {
    EXPECT_TRUE(content(path) == content("undisturbed.h5"));
    EXPECT_FALSE(fs::exists(path + ".parts"));
  });
  clear("undisturbed.h5");
  clear(path);
}

TEST(Sweep, UnfinishedShowsWhatIsThere) {
  const Layout layout = sample_layout(10);
  leave_unfinished("unfinished.h5", layout);
  alone([&] {
    const Archive archive = read_archive("unfinished.h5");
    const Variable& status = archive.variables.at("status");
    EXPECT_EQ(status.attributes.at("flag_values").substr(0, 6), "-1 0 1");
    EXPECT_EQ(status.attributes.at("flag_meanings").substr(0, 15), "pending contact");
    EXPECT_EQ(status.dimensions, (std::vector<std::string>{"case", "segment"}));
    EXPECT_EQ(archive.variables.at("case").numbers, (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
    for (std::size_t row = 0; row < 30; ++row) {
      const bool there = row < 12 || row >= 24;
      EXPECT_EQ(status.numbers.at(row), there ? static_cast<double>(row % 7) : -1) << row;
      EXPECT_EQ(std::isnan(archive.variables.at("volume_rest").numbers.at(row)), !there) << row;
    }
    EXPECT_EQ(archive.variables.at("voltage").numbers.at(9), 9000);
    EXPECT_TRUE(std::isnan(archive.variables.at("voltage").numbers.at(5)));
    EXPECT_NE(archive.attributes.at("incomplete").find("unfinished.h5.parts"), std::string::npos);
  });
  EXPECT_EQ(finished_chunks("unfinished.h5", layout), (std::vector<bool>{true, false, true}));
  expect_finishes("unfinished.h5", layout);
}

TEST(Sweep, OfVeryManyChunksShowsNoneUntilItsEnd) {
  const Layout layout = sample_layout(300);
  clear("many.h5");
  {
    SweepArchive archive(MPI_COMM_WORLD, "many.h5", layout, sample_provenance(), 1);
    alone([&] {
      store_sample(archive, 7, 3);
      const Archive shown = read_archive("many.h5");
      const auto& status = shown.variables.at("status").numbers;
      EXPECT_EQ(std::count(status.begin(), status.end(), -1), 900);
      EXPECT_NE(shown.attributes.at("incomplete").find("too many to show"), std::string::npos);
      EXPECT_EQ(read_archive("many.h5.parts/chunk-000007.h5").variables.at("case").numbers,
                std::vector<double>{7});
    });
  }
  const SweepArchive again(MPI_COMM_WORLD, "many.h5", layout, sample_provenance(), 1);
  EXPECT_TRUE(again.finished(7));
  EXPECT_FALSE(again.finished(8));
  clear("many.h5");
}

TEST(Sweep, CompleteOneIsLeftAlone) {
  const Layout layout = sample_layout(10);
  write_sample(MPI_COMM_WORLD, "complete.h5", layout, chunk_cases);
  const auto written = fs::last_write_time("complete.h5");
  Provenance later = sample_provenance();
  later.created = "2027-01-01T00:00:00Z";
  later.ranks = 64;
  later.command = "gaiter sweep -options_file again.yaml";
  SweepArchive archive(MPI_COMM_WORLD, "complete.h5", layout, later, 7);
  EXPECT_TRUE(archive.complete());
  for (std::size_t i = 0; i < archive.chunks(); ++i) {
    EXPECT_TRUE(archive.finished(i));
  }
  archive.finish();
  EXPECT_EQ(fs::last_write_time("complete.h5"), written);
  EXPECT_FALSE(fs::exists("complete.h5.parts"));
  clear("complete.h5");
}

// Killed after the archive had its name, before the chunks' files were gone.
TEST(Sweep, LeftoversOfACompleteOneAreRemoved) {
  const Layout layout = sample_layout(10);
  leave_unfinished("leftover.h5", layout);
  write_sample(MPI_COMM_WORLD, "leftover_whole.h5", layout, chunk_cases);
  alone([&] { fs::rename("leftover_whole.h5", "leftover.h5"); });
  EXPECT_EQ(finished_chunks("leftover.h5", layout), (std::vector<bool>{true, true, true}));
  alone([&] { EXPECT_FALSE(fs::exists("leftover.h5.parts")); });
  clear("leftover.h5");
}

TEST(Sweep, ChunksSurviveTheLossOfTheFileThatShowsThem) {
  const Layout layout = sample_layout(10);
  leave_unfinished("shown.h5", layout);
  alone([&] { fs::remove("shown.h5"); });
  EXPECT_EQ(finished_chunks("shown.h5", layout), (std::vector<bool>{true, false, true}));
  expect_finishes("shown.h5", layout);
}

TEST(Sweep, DamagedChunksAreComputedAgain) {
  const Layout layout = sample_layout(10);
  const auto damage = [&](const std::function<void(const std::string&)>& harm) {
    leave_unfinished("damaged.h5", layout);
    alone([&] { harm("damaged.h5.parts/chunk-000002.h5"); });
    EXPECT_EQ(finished_chunks("damaged.h5", layout), (std::vector<bool>{true, false, false}));
    expect_finishes("damaged.h5", layout);
  };
  damage([](const std::string& path) { fs::resize_file(path, 0); });
  damage([](const std::string& path) { fs::resize_file(path, 10); });
  damage([](const std::string& path) { fs::resize_file(path, fs::file_size(path) - 1); });
  damage([](const std::string& path) { fs::resize_file(path, fs::file_size(path) / 2); });
  damage([](const std::string& path) { std::ofstream(path, std::ios::app) << "x"; });
  damage([](const std::string& path) {  // as after a loss of power: the length without the bytes
    const auto size = fs::file_size(path);
    fs::resize_file(path, 0);
    fs::resize_file(path, size);
  });
  for (const double place : {0.01, 0.5, 0.9, 0.999}) {
    damage([&](const std::string& path) {
      std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
      const auto position = static_cast<std::streamoff>(place * static_cast<double>(fs::file_size(path)));
      file.seekg(position);
      const char letter = static_cast<char>(file.get() ^ 0x10);
      file.seekp(position);
      file.put(letter);
    });
  }
}

TEST(Sweep, RefusesOtherOptionsAndNamesThem) {
  const Layout layout = sample_layout(10);
  Provenance run = sample_provenance();
  for (const bool finished : {false, true}) {
    const std::string kind =
        std::string("-output other.h5: ") + (finished ? "a finished" : "an unfinished") + " archive ";
    if (finished) {
      write_sample(MPI_COMM_WORLD, "other.h5", layout, chunk_cases);
    } else {
      leave_unfinished("other.h5", layout);
    }
    Provenance other = run;
    other.options = "fidelity: slice\nvoltage: 12 kV\n";
    EXPECT_EQ(refusal("other.h5", layout, other),
              kind +
                  "is there, of a sweep with other options: -fidelity not given (now slice), -voltage "
                  "11.3 kV (now 12 kV); choose another name or remove it");
    other = run;
    other.gaiter_version = "0.2.0";
    EXPECT_EQ(refusal("other.h5", layout, other),
              kind +
                  "of another program is there: of gaiter 0.1.0 with PETSc 3.18.5 (now gaiter 0.2.0 with "
                  "PETSc 3.18.5); choose another name or remove it");
    Layout fewer = layout;
    fewer.columns = {"volume_rest"};
    EXPECT_NE(refusal("other.h5", fewer, run).find("-output_variables "), std::string::npos);
    EXPECT_NE(refusal("other.h5", sample_layout(11), run).find("cases 10 (now 11)"), std::string::npos);
    EXPECT_NE(refusal("other.h5", sample_layout(10, {"r6"}), run).find("segments r6,r5,"), std::string::npos);
    EXPECT_EQ(refusal("other.h5", layout, run, 5).empty(), finished);
  }
  // What was refused has changed nothing.
  EXPECT_EQ(finished_chunks("other.h5", layout), (std::vector<bool>{true, true, true}));
  clear("other.h5");
}

TEST(Sweep, RefusesChunksOfAnotherSweepWithoutItsFile) {
  const Layout layout = sample_layout(10);
  leave_unfinished("foreign.h5", layout);
  alone([&] { fs::remove("foreign.h5"); });
  Provenance other = sample_provenance();
  other.options = "voltage: 12 kV\n";
  EXPECT_EQ(refusal("foreign.h5", layout, other),
            "-output foreign.h5: the folder foreign.h5.parts holds chunks of another sweep; remove it or "
            "choose another name");
  EXPECT_EQ(finished_chunks("foreign.h5", layout), (std::vector<bool>{true, false, true}));
  clear("foreign.h5");
}

TEST(Sweep, RefusesWhatIsNoArchive) {
  alone([&] { std::ofstream("text.h5") << "results of last week"; });
  EXPECT_EQ(refusal("text.h5", sample_layout(10), sample_provenance()),
            "-output text.h5: this file is there already and is no archive of gaiter; choose another name");
  EXPECT_EQ(content("text.h5"), "results of last week");
  EXPECT_FALSE(fs::exists("text.h5.parts"));
  clear("text.h5");
}

TEST(Sweep, SecondRunOnOneArchiveIsRefused) {
  const Layout layout = sample_layout(10);
  leave_unfinished("twice.h5", layout);
  {
    SweepArchive first(MPI_COMM_WORLD, "twice.h5", layout, sample_provenance(), chunk_cases);
    EXPECT_EQ(
        refusal("twice.h5", layout, sample_provenance()),
        "-output twice.h5: another run is writing this archive; wait for its end or choose another name");
  }
  expect_finishes("twice.h5", layout);
}

TEST(Sweep, FullDiskIsOfOneRankAloneAndLosesNothing) {
  const Layout layout = sample_layout(20000);
  clear("full.h5");
  {
    SweepArchive archive(MPI_COMM_WORLD, "full.h5", layout, sample_provenance(), 15000);
    const auto last = static_cast<std::size_t>(size_of(MPI_COMM_WORLD) - 1);
    if (static_cast<std::size_t>(rank_in(MPI_COMM_WORLD)) == last) {
      store_sample(archive, 1, 3);
      const FileLimit limit(200000);
      EXPECT_EQ(message_of<base::InternalError>([&] { store_sample(archive, 0, 3); }),
                "-output full.h5: chunk 0 cannot be stored: cannot write full.h5.parts/chunk-000000.h5: File "
                "too large; the chunks stored before are kept, and the same command continues the run");
    }
    MPI_Barrier(MPI_COMM_WORLD);
    EXPECT_EQ(
        message_of<base::InternalError>([&] { archive.finish(); }),
        "-output full.h5: chunk 0 is not stored; the chunks stored before are kept, and the same command "
        "continues the run");
  }
  {
    SweepArchive archive(MPI_COMM_WORLD, "full.h5", layout, sample_provenance(), 15000);
    EXPECT_FALSE(archive.finished(0));
    EXPECT_TRUE(archive.finished(1));
    if (on_first_rank()) {
      store_sample(archive, 0, 3);
    }
    MPI_Barrier(MPI_COMM_WORLD);
    std::string message;
    {
      const FileLimit limit(200000);
      message = message_of<base::InternalError>([&] { archive.finish(); });
    }
    EXPECT_TRUE(std::regex_match(
        message, std::regex("-output full.h5: cannot make room for [0-9]+ bytes: File too large; the chunks "
                            "stored before are kept, and the same command continues the run")))
        << message;
    alone([&] { EXPECT_EQ(read_archive("full.h5").attributes.count("incomplete"), 1u); });
    archive.finish();  // there is room again
  }
  alone([&] { expect_rows(read_archive("full.h5"), sample_rows(0, layout.rows())); });
  clear("full.h5");
}

TEST(Sweep, AFullDiskShowsOnAllRanksAtTheEndAtTheLatest) {
  const Layout layout = sample_layout(20000);
  clear("late.h5");
  {
    SweepArchive archive(MPI_COMM_WORLD, "late.h5", layout, sample_provenance(), 20000);
    std::string message;
    {
      const FileLimit limit(200000);
      if (rank_in(MPI_COMM_WORLD) == size_of(MPI_COMM_WORLD) - 1) {
        archive.store(0, sample_rows(0, layout.rows()), sample_times(0, 20000), sample_swept(0, 20000));
      }
      message = message_of<base::InternalError>([&] { archive.finish(); });
    }
    EXPECT_NE(message.find("-output late.h5: chunk 0 cannot be stored: "), std::string::npos) << message;
  }
  clear("late.h5");
}

TEST(Sweep, RefusesResultsThatDoNotFit) {
  const Layout layout = sample_layout(10);
  clear("fit.h5");
  SweepArchive archive(MPI_COMM_WORLD, "fit.h5", layout, sample_provenance(), chunk_cases);
  const auto problem = [&](std::size_t chunk, std::size_t rows, std::size_t times, std::size_t values) {
    return message_of<base::InternalError>(
        [&] { archive.store(chunk, sample_rows(0, rows), sample_times(0, times), sample_swept(0, values)); });
  };
  EXPECT_NE(problem(0, 11, 4, 4).find("chunk 0 cannot be stored: 11 rows given, 12 expected"),
            std::string::npos);
  EXPECT_NE(problem(0, 12, 3, 4).find("3 wall times given, 4 expected"), std::string::npos);
  EXPECT_NE(problem(0, 12, 4, 5).find("5 values of bandage_stretch given, 4 expected"), std::string::npos);
  EXPECT_NE(problem(2, 12, 4, 4).find("12 rows given, 6 expected"), std::string::npos);
  EXPECT_NE(problem(3, 12, 4, 4).find("no such chunk"), std::string::npos);
  EXPECT_EQ(problem(0, 12, 4, 4), "");
  archive.flush();
  MPI_Barrier(MPI_COMM_WORLD);  // no rank writes any more when the folder is cleared
  EXPECT_NE(message_of<base::InternalError>([] {
              SweepArchive(MPI_COMM_WORLD, "none.h5", sample_layout(0), sample_provenance(), 1);
            }).find("-output none.h5: it would hold no result"),
            std::string::npos);
  EXPECT_FALSE(fs::exists("none.h5.parts"));
  clear("fit.h5");
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
