// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/axisym_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "gaiter/archive/agree.hpp"
#include "gaiter/archive/durable_file.hpp"
#include "gaiter/archive/vtk_file.hpp"

namespace gaiter::studies {

namespace {

using base::InputError;

// ParaView chooses its reader by the name: .hdf from 5.10 on, .vtkhdf from 5.12 on.
constexpr const char* endings[] = {".hdf", ".vtkhdf"};

// Every `of` values of a row are of one point or cell: those from `from` on, `count` of them, then zeros.
std::vector<double> columns(const std::vector<double>& values, std::size_t of, std::size_t from,
                            std::size_t count, std::size_t zeros = 0) {
  std::vector<double> result;
  for (std::size_t row = 0; row < values.size(); row += of) {
    for (std::size_t k = 0; k < count; ++k) result.push_back(values[row + from + k]);
    result.insert(result.end(), zeros, 0.0);
  }
  return result;
}

archive::VtkGrid grid_of(const solvers::AxisymFields& fields) {
  archive::VtkGrid grid{fields.order, fields.position, fields.cells, {}, {}};
  auto& arrays = grid.point_arrays;
  arrays.push_back({"displacement", "m", "displacement along r, along z, and 0", 3,
                    columns(fields.displacement, 2, 0, 2, 1)});
  std::vector<double> pressure;
  for (std::size_t k = 0; k < fields.stress.size(); k += 4)
    pressure.push_back(-(fields.stress[k] + fields.stress[k + 1] + fields.stress[k + 3]) / 3);
  arrays.push_back({"pressure", "Pa", "minus the mean Cauchy stress", 1, std::move(pressure)});
  const char* components[] = {"rr", "zz", "rz", "tt"};
  for (std::size_t k = 0; k < 4; ++k)
    arrays.push_back({fmt::format("stress_{}", components[k]), "Pa",
                      fmt::format("Cauchy stress {}, Maxwell's included", components[k]), 1,
                      columns(fields.stress, 4, k, 1)});
  arrays.push_back({"contact_pressure", "Pa", "normal pressure on the contact surfaces, 0 elsewhere", 1,
                    fields.contact_pressure});
  std::vector<std::int32_t> body;
  for (int tube : fields.tube) body.push_back(tube ? 0 : 1);
  grid.cell_arrays.push_back({"body", "1", "0 bandage, 1 leg", 1, std::move(body)});
  grid.cell_arrays.push_back({"segment",
                              "1",
                              "segment of the leg, from 0 at the ankle up",
                              1,
                              {fields.segment.begin(), fields.segment.end()}});
  return grid;
}

bool ends_well(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension();
  return std::ranges::find(endings, ending) != std::end(endings);
}

}  // namespace

std::vector<View> views_of(const Request& request) {
  std::vector<View> views;
  if (request.axisym_view.empty()) return views;
  const std::filesystem::path path(request.axisym_view);
  const auto& segments = request.scene.leg.segments;
  const bool whole = request.scene.axisym.scope == model::AxisymScope::leg || segments.size() == 1;
  const auto has_voltage = [](const model::Module& module) { return module.voltage != 0; };
  for (std::size_t s = 0; s < (whole ? 1 : segments.size()); ++s)
    for (bool actuated : {false, true}) {
      const auto& modules = request.scene.bandage.modules;
      if (actuated && !(whole ? std::ranges::any_of(modules, has_voltage) : has_voltage(modules[s])))
        continue;
      const std::string name =
          fmt::format("{}{}_{}{}", path.stem().string(), whole ? "" : "_" + segments[s].name,
                      actuated ? "actuated" : "rest", path.extension().string());
      views.push_back({s, actuated, (path.parent_path() / name).string()});
    }
  return views;
}

void check_views(Command command, const Request& request) {
  const std::string& path = request.axisym_view;
  if (path.empty()) return;
  if (command != Command::solve)
    throw InputError(
        fmt::format("-axisym_view '{}': belongs to the command solve; a sweep writes no fields", path));
  if (request.scene.fidelity != model::Fidelity::axisym)
    throw InputError(
        fmt::format("-axisym_view '{}': only -fidelity 'axisym' has finite element fields to write", path));
  if (!ends_well(path))
    throw InputError(
        fmt::format("-axisym_view '{}': must be a file name that ends in .hdf or .vtkhdf", path));
}

void check_views_writable(const Request& request) {
  for (const View& view : views_of(request))
    archive::check_writable(view.path, "-axisym_view", std::filesystem::path(view.path).extension());
}

std::string write_views(MPI_Comm comm, const Request& request,
                        const std::vector<solvers::AxisymFields>& found) {
  const std::vector<View> views = views_of(request);
  if (views.empty()) return "";
  std::vector<int> written(views.size(), 0);
  archive::agreed(comm, "-axisym_view", [&] {
    for (const auto& fields : found)
      for (std::size_t v = 0; v < views.size(); ++v)
        if (views[v].first_segment == fields.first_segment && views[v].actuated == fields.actuated) {
          archive::write_vtk(views[v].path, grid_of(fields));
          written[v] = 1;
        }
  });
  MPI_Allreduce(MPI_IN_PLACE, written.data(), static_cast<int>(written.size()), MPI_INT, MPI_MAX, comm);
  std::string report;
  for (std::size_t v = 0; v < views.size(); ++v) {
    std::error_code ignored;
    if (!written[v]) std::filesystem::remove(views[v].path, ignored);
    report += fmt::format("{} {}\n", written[v] ? "wrote" : "no state was found for", views[v].path);
  }
  return report;
}

}  // namespace gaiter::studies
