// SPDX-License-Identifier: BSD-2-Clause
// Slices, sliding slices and axisymmetric finite elements of the same conical segments, at rest and under
// voltage, a row of a CSV table each. model_map.py runs it and makes tables and figures of it. Usage:
//   model_map [-draws COUNT [-first N]] [-refine 1] [-part K -parts N] [-output FILE.csv]
// Without -draws: the map. -refine: of the elements; from 1 on their own error is estimated. -part and -parts
// share the work between processes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/model_error.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "gaiter/solvers/sliding_model.hpp"
#include "model_error_draws.hpp"

namespace {

using namespace gaiter;

constexpr double permittivity_of_vacuum = 8.8541878128e-12;  // [F/m]

model::SegmentResult elements(model::Scene scene, int refine, model::ContactAxial axial) {
  scene.fidelity = model::Fidelity::axisym;
  scene.axisym.refine = refine;
  scene.contact_axial = axial;
  const solvers::SegmentTask task{&scene, 0};
  return solvers::solve_axisym(PETSC_COMM_SELF, {&task, 1})[0];
}

model::SegmentResult slices(const model::Scene& scene) {
  const solvers::SegmentTask task{&scene, 0};
  return solvers::solve_segments(PETSC_COMM_SELF, {&task, 1})[0];
}

// The last stable voltage by finite elements on the coarsest mesh, sought up to the voltage whose stress
// alone would take off twice the pressure at rest; NaN if not even the state at rest is found.
double last_stable_voltage(model::Scene scene) {
  const double pressure = slices(scene).pressure_rest, radius = scene.leg.segments[0].mean_radius();
  const double stretch = scene.bandage.modules[0].stretch, wall = scene.bandage.thickness / stretch;
  const double permittivity = permittivity_of_vacuum * scene.bandage.permittivity;
  scene.bandage.modules[0].voltage = wall * std::sqrt(2 * pressure * radius / (permittivity * wall));
  const double found = elements(scene, 0, model::ContactAxial::free).voltage_stable;
  return found > 0 ? found : NAN;
}

class Table {
 public:
  explicit Table(const std::string& name) : file_(std::fopen(name.c_str(), "w"), &std::fclose) {
    if (!file_) throw std::runtime_error("cannot write " + name);
    std::fprintf(
        file_.get(),
        "taper,stretch,slenderness,compliance,wall,stiffness,alpha,mooney,leg_shear,poisson,region,voltage,"
        "voltage_part");
    for (const char* model : {"slice", "sliding", "axisym", "held"})
      for (const char* name : {"status", "pressure_rest", "pressure_actuated", "actuation_drop",
                               "volume_change", "slip_max", "error_estimate"})
        std::fprintf(file_.get(), ",%s_%s", model, name);
    for (const char* model : {"slice", "sliding"})
      for (const char* name : {"pressure_rest", "pressure_actuated", "actuation_drop", "volume_change"})
        std::fprintf(file_.get(), ",%s_%s_model_error", model, name);
    std::fprintf(file_.get(), "\n");
  }

  void add(const ConeCase& c, const model::Scene& scene, double part,
           const std::vector<model::SegmentResult>& results) {
    std::fprintf(file_.get(), "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%d,%.17g,%.17g",
                 c.taper, c.stretch, c.slenderness, c.compliance, c.wall, c.stiffness, c.alpha, c.mooney,
                 c.leg_shear, c.poisson, c.region, scene.bandage.modules[0].voltage, part);
    for (const model::SegmentResult& r : results)
      std::fprintf(file_.get(), ",%d,%.15g,%.15g,%.15g,%.15g,%.6g,%.3g", static_cast<int>(r.status),
                   r.pressure_rest, r.pressure_actuated, r.actuation_drop, r.volume_change, r.slip_max,
                   r.error_estimate);
    const physics::ModelErrors errors = physics::model_errors(scene, 0, results[0]);
    for (const physics::ModelError& e : {errors.slice, errors.sliding})
      std::fprintf(file_.get(), ",%.6g,%.6g,%.6g,%.6g", e.pressure_rest, e.pressure_actuated,
                   e.actuation_drop, e.volume_change);
    std::fprintf(file_.get(), "\n");
    std::fflush(file_.get());
  }

 private:
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

// A row at rest, and one for each part of the last stable voltage.
void solve(const ConeCase& c, const std::vector<double>& parts, int refine, Table& table) {
  model::Scene scene = scene_of(c);
  // Under voltage only where the estimate claims to know; elsewhere the last stable one is costly to find.
  const auto row = [&](double part) {
    std::vector<model::SegmentResult> results{slices(scene), solvers::solve_sliding({&scene, 0}).result};
    results.push_back(elements(scene, refine, model::ContactAxial::free));
    results.push_back(part == 0 ? elements(scene, 0, model::ContactAxial::held)
                                : model::without_numbers(model::Status::invalid, model::Fidelity::axisym));
    table.add(c, scene, part, results);
    return model::trustworthy(results[2].status) && physics::model_shifts(scene, 0, results[0]).rest_known;
  };
  if (!row(0)) return;
  const double last = parts.empty() ? NAN : last_stable_voltage(scene);
  if (std::isnan(last)) return;
  for (double part : parts) {
    scene.bandage.modules[0].voltage = part * last;
    row(part);
  }
}

// One set of the map: every taper with every stretch, and what they have in common.
struct Panel {
  double slenderness = 1, compliance = 1, wall = 0.025, alpha = 0, stiffness = 1;
  std::vector<double> voltage_parts{};
};

std::vector<Panel> panels() {
  std::vector<Panel> all{{.voltage_parts = {0.5, 0.8}}};
  for (double slenderness : {0.3, 0.5, 1.0, 2.0, 5.0})
    for (double compliance : {1e-4, 0.1, 1.0, 10.0})  // the first one is as good as rigid
      if (slenderness != 1 || compliance != 1)
        all.push_back({.slenderness = slenderness, .compliance = compliance});
  for (double wall : {0.005, 0.05}) all.push_back({.wall = wall});
  for (double stiffness : {1.0, 10.0}) all.push_back({.alpha = 2, .stiffness = stiffness});
  return all;
}

constexpr double widest = 1.2;  // difference of a segment's end radii over their mean

// The leg's shear modulus follows its compliance: the whole leg is softer or stiffer.
ConeCase cone(const Panel& panel, double degrees, double stretch) {
  ConeCase c;
  c.taper = degrees * M_PI / 180;
  c.stretch = stretch;
  c.slenderness = panel.slenderness;
  c.compliance = panel.compliance;
  c.wall = panel.wall;
  c.alpha = panel.alpha;
  c.stiffness = panel.stiffness;
  c.leg_shear = 10e3 / panel.compliance;
  return c;
}

struct Job {
  ConeCase cone;
  std::vector<double> voltage_parts;
};

std::vector<Job> map_jobs() {
  std::vector<Job> jobs;
  for (const Panel& panel : panels())
    for (double degrees = 0; degrees <= 20; degrees += 2.5)
      for (double stretch : {1.05, 1.1, 1.2, 1.3, 1.4, 1.6, 1.8, 2.0, 2.2}) {
        const ConeCase c = cone(panel, degrees, stretch);
        if (std::tan(c.taper) * c.slenderness <= widest) jobs.push_back({c, panel.voltage_parts});
      }
  return jobs;
}

// Every second draw is solved under voltage too.
std::vector<Job> drawn_jobs(int first, int count) {
  std::vector<Job> jobs;
  for (const ConeCase& c : draw_cones(first, count))
    jobs.push_back({c, jobs.size() % 2 == 0 ? std::vector{c.voltage_part} : std::vector<double>{}});
  return jobs;
}

}  // namespace

int main(int argc, char** argv) {
  petsc::Session session(std::vector<std::string>(argv + 1, argv + argc));
  PetscInt draws = 0, first = 0, refine = 1, part = 0, parts = 1;
  char output[PETSC_MAX_PATH_LEN] = "model_map.csv";
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, "-draws", &draws, nullptr));
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, "-first", &first, nullptr));
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, "-refine", &refine, nullptr));
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, "-part", &part, nullptr));
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, "-parts", &parts, nullptr));
  petsc::check(PetscOptionsGetString(nullptr, nullptr, "-output", output, sizeof output, nullptr));
  const std::vector<Job> jobs = draws > 0 ? drawn_jobs(first, draws) : map_jobs();
  Table table(output);
  for (std::size_t k = part; k < jobs.size(); k += parts)
    solve(jobs[k].cone, jobs[k].voltage_parts, refine, table);
}
