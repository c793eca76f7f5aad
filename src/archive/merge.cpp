// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/merge.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "gaiter/archive/agree.hpp"
#include "gaiter/archive/chunk_file.hpp"
#include "gaiter/archive/durable_file.hpp"
#include "gaiter/archive/laid_out_file.hpp"
#include "gaiter/archive/table_file.hpp"
#include "gaiter/base/error.hpp"
#include "gaiter/petsc/session.hpp"

namespace gaiter::archive {
namespace {

class OpenFile {
 public:
  OpenFile(const std::string& path, int flags)
      : path_(path), descriptor_(::open(path.c_str(), flags | O_CLOEXEC)) {
    require(descriptor_ >= 0, "open");
  }
  ~OpenFile() {
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int get() const { return descriptor_; }
  void read_all(std::vector<std::byte>& bytes) {
    const off_t size = ::lseek(descriptor_, 0, SEEK_END);
    require(size >= 0, "read");
    bytes.resize(static_cast<std::size_t>(size));
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t got =
          ::pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
      require(got > 0 || (got < 0 && errno == EINTR), "read");
      done += got > 0 ? static_cast<std::size_t>(got) : 0;
    }
  }
  void bring_to_disk() { require(::fsync(descriptor_) == 0, "bring to the disk"); }
  void close() { require(::close(std::exchange(descriptor_, -1)) == 0, "write"); }

 private:
  void require(bool ok, const std::string& action) const {
    if (!ok) {
      throw base::InternalError("cannot " + action + " " + path_ + ": " + std::strerror(errno));
    }
  }

  std::string path_;
  int descriptor_;
};

// One number for each variable of each chunk; of a rank, those of its share, of all of them, the shares one
// after the other.
using Numbers = std::vector<std::uint64_t>;

class Merge {
 public:
  Merge(MPI_Comm comm, const std::string& context, const std::string& path, const RunFolder& folder,
        const Layout& layout, std::size_t chunks)
      : comm_(comm),
        context_(context),
        path_(path),
        folder_(folder),
        layout_(layout),
        chunks_(chunks),
        variables_(variables_of(layout).size()),
        ranks_(petsc::size(comm)) {
    for (std::size_t i = 0; i < chunks; ++i) {
      if (is_share_of(petsc::rank(comm), ranks_, i)) {
        share_.push_back(i);
      }
    }
    MPI_Type_contiguous(static_cast<int>(variables_), MPI_UINT64_T, &chunk_type_);
    MPI_Type_commit(&chunk_type_);
  }
  ~Merge() { MPI_Type_free(&chunk_type_); }
  Merge(const Merge&) = delete;
  Merge& operator=(const Merge&) = delete;

  void run(const Provenance& provenance, std::size_t chunk_cases) {
    Numbers sizes;
    agreed(comm_, context_, [&] {
      for (const std::size_t chunk : share_) {
        for (const Extent& extent : places_in(folder_.chunk_path(chunk), variables_)) {
          sizes.push_back(extent.bytes);
        }
      }
    });
    Numbers all = exchange(sizes, true);
    agreed(comm_, context_, [&] {
      if (petsc::rank(comm_) == 0) {
        lay_out(provenance, chunk_cases, all);
      }
    });
    const Numbers places = exchange(all, false);
    agreed(comm_, context_, [&] { copy(places); });
  }

 private:
  // How many chunks come before a rank's share, and are in it.
  std::pair<std::vector<int>, std::vector<int>> shares() const {
    std::vector<int> before(static_cast<std::size_t>(ranks_), 0), count = before;
    const auto ranks = static_cast<std::size_t>(ranks_);
    for (std::size_t rank = 0, sum = 0; rank < ranks; ++rank) {
      const std::size_t mine = chunks_ / ranks + (rank < chunks_ % ranks ? 1 : 0);
      before[rank] = static_cast<int>(sum);
      count[rank] = static_cast<int>(mine);
      sum += mine;
    }
    return {before, count};
  }

  // From all ranks to the first, or back.
  Numbers exchange(const Numbers& from, bool to_first) const {
    const auto [before, count] = shares();
    const bool first = petsc::rank(comm_) == 0;
    const auto mine = static_cast<int>(share_.size());
    Numbers to((to_first ? (first ? chunks_ : 0) : share_.size()) * variables_);
    if (to_first) {
      MPI_Gatherv(from.data(), mine, chunk_type_, to.data(), count.data(), before.data(), chunk_type_, 0,
                  comm_);
    } else {
      MPI_Scatterv(from.data(), count.data(), before.data(), chunk_type_, to.data(), mine, chunk_type_, 0,
                   comm_);
    }
    return to;
  }

  // Turns the sizes of all into their places. In the order of the chunks, for then the file does not depend
  // on the ranks.
  void lay_out(const Provenance& provenance, std::size_t chunk_cases, Numbers& numbers) const {
    const QuietErrors quiet;
    const LimitIsAnError guard;
    const std::vector<int> before = shares().first;
    LaidOutFile file(path_);
    {
      const std::vector<Id> made =
          fill_file(file.get(), layout_, provenance, {0, layout_.cases, chunk_cases});
      const auto ranks = static_cast<std::size_t>(ranks_);
      for (std::size_t i = 0; i < chunks_; ++i) {
        std::uint64_t* number =
            &numbers[(static_cast<std::size_t>(before[i % ranks]) + i / ranks) * variables_];
        for (std::size_t v = 0; v < variables_; ++v, ++number) {
          *number = file.place(made[v].get(), i * chunk_cases, *number);
        }
      }
    }
    file.close();
  }

  void copy(const Numbers& places) const {
    const LimitIsAnError guard;
    OpenFile merged(path_, O_WRONLY);
    std::vector<std::byte> bytes;
    auto place = places.begin();
    for (const std::size_t chunk : share_) {
      const std::string part_path = folder_.chunk_path(chunk);
      OpenFile(part_path, O_RDONLY).read_all(bytes);
      for (const Extent& extent : places_in(part_path, variables_)) {
        if (extent.place > bytes.size() || extent.bytes > bytes.size() - extent.place) {
          throw base::InternalError(part_path + " is damaged");
        }
        write_at(merged.get(), std::span<const std::byte>(bytes).subspan(extent.place, extent.bytes),
                 *place++);
      }
      // The disk begins while the next chunk is copied. Only advice: what it must have, the end waits for.
      ::sync_file_range(merged.get(), 0, 0, SYNC_FILE_RANGE_WRITE);
    }
    merged.bring_to_disk();
    merged.close();
  }

  MPI_Comm comm_;
  const std::string& context_;
  const std::string& path_;
  const RunFolder& folder_;
  const Layout& layout_;
  std::size_t chunks_, variables_;
  int ranks_;
  std::vector<std::size_t> share_;
  MPI_Datatype chunk_type_ = MPI_DATATYPE_NULL;
};

}  // namespace

void merge_chunks(MPI_Comm comm, const std::string& context, const std::string& path, const RunFolder& folder,
                  const Layout& layout, const Provenance& provenance, std::size_t chunk_cases) {
  int length = static_cast<int>(path.size());
  MPI_Bcast(&length, 1, MPI_INT, 0, comm);
  std::string name = path;  // the first rank's
  name.resize(static_cast<std::size_t>(length));
  MPI_Bcast(name.data(), length, MPI_CHAR, 0, comm);
  Merge(comm, context, name, folder, layout, (layout.cases + chunk_cases - 1) / chunk_cases)
      .run(provenance, chunk_cases);
}

}  // namespace gaiter::archive
