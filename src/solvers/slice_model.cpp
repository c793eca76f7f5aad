// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/slice_model.hpp"

#include <algorithm>
#include <cmath>

#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/branch.hpp"
#include "gaiter/physics/segment_summary.hpp"
#include "gaiter/physics/slice_kernel.hpp"
#include "gaiter/physics/wall_resolution.hpp"
#include "gaiter/solvers/slice_solver.hpp"

namespace gaiter::solvers {

namespace {

using model::Status;
using physics::Pack;
using physics::pack_width;
using physics::PackState;
using physics::SliceOutcome;
using physics::SliceShape;
using physics::SliceSystem;

constexpr double wall_tolerance =
    1e-12;                      // of the quadrature through the wall, where the points are chosen here
constexpr double caution = 10;  // of an error estimated from starting values instead of solutions
constexpr double smallest_error = 4e-15;  // of a sum of some slices, by rounding
constexpr int most_check_points = 128;    // over the height, of the rule that an error estimate compares with
// f' of the scalar equation of a slice: 1 for a bandage that does not stiffen or soften with the leg's
// radius. Below this there may be a limit point near by, and the equilibrium is searched for along the path.
constexpr double doubtful_slope = 0.5;

double voltage_of(const SegmentTask& task) {
  return task.scene->bandage.modules[task.segment].voltage;
}

// A passive bandage of these terms presses harder the further it is stretched, so that there is one
// equilibrium.
bool stiffens(const model::Bandage& bandage) {
  return std::all_of(bandage.ogden.begin(), bandage.ogden.end(), [](const model::OgdenTerm& term) {
    return term.mu * term.alpha >= 0 && std::fabs(term.alpha) >= 2;
  });
}

// The slices of this rank's tasks, and their solution on the way from rest to the actuated state.
class SliceStudy {
 public:
  SliceStudy(MPI_Comm comm, std::span<const SegmentTask> tasks);
  std::vector<model::SegmentResult> run();

 private:
  void set_constants();
  void rigid_pressures();
  std::vector<double> height_errors(bool rigid) const;
  void rest(SliceSolver& solver);
  void actuate(SliceSolver& solver);
  void solve_doubtful(SliceSolver& solver, bool at_rest);
  void record(bool at_rest);
  void float_free(std::size_t slice);
  void finish_actuated();
  template <typename Action>
  void each_slice(Action&& action);  // action(slice, task, its pack, its place in the pack)

  MPI_Comm comm_;
  std::span<const SegmentTask> tasks_;
  std::vector<std::size_t> first_;               // first slice of each task, and the end
  std::vector<physics::Quadrature> rules_;       // over the height, of each task
  std::vector<physics::Quadrature> wall_rules_;  // through the wall
  bool energised_ = false;                       // somewhere, on any rank
  bool newton_ = true;                           // all ranks agree, those without tasks too
  SliceSystem system_;
  std::vector<PackState> states_;
  std::vector<SliceOutcome> outcomes_;
  std::vector<Pack> rest_pressure_;
};

int count_slices(std::span<const SegmentTask> tasks) {
  int count = 0;
  for (const SegmentTask& task : tasks) count += task.scene->discretisation.slice_count;
  return count;
}

int wall_points_of(const SegmentTask& task) {
  const int asked = task.scene->discretisation.wall_points;
  return asked > 0 ? asked : physics::wall_points_for(*task.scene, task.segment, wall_tolerance);
}

// What all of these tasks fit into.
SliceShape common_shape(std::span<const SegmentTask> tasks) {
  SliceShape shape;
  int points = 1;
  for (const SegmentTask& task : tasks) {
    const model::Scene& scene = *task.scene;
    points = std::max(points, wall_points_of(task));
    shape.layers = std::max(shape.layers, voltage_of(task) != 0 ? scene.bandage.layers : 0);
    shape.ogden_terms = static_cast<int>(scene.bandage.ogden.size());
    shape.material = scene.leg.material;
  }
  shape.wall = physics::gauss_legendre(points);
  return shape;
}

// Puts a slice of a task, at a height from 0 to 1, into a system; gives the undeformed radius of the leg
// there.
double set_slice(SliceSystem& system, std::size_t slice, const SegmentTask& task, double height,
                 const physics::Quadrature& wall_rule) {
  const model::Scene& scene = *task.scene;
  const model::Segment& segment = scene.leg.segments[task.segment];
  const model::Module& module = scene.bandage.modules[task.segment];
  const double radius = segment.lower_radius + height * (segment.upper_radius - segment.lower_radius);
  const physics::Wall wall = physics::reference_wall(scene.bandage, module, segment.mean_radius(), radius);
  system.set(slice, scene.leg, segment, scene.bandage, wall, radius, module.voltage, &wall_rule);
  return radius;
}

SliceStudy::SliceStudy(MPI_Comm comm, std::span<const SegmentTask> tasks)
    : comm_(comm),
      tasks_(tasks),
      system_(common_shape(tasks), count_slices(tasks)),
      states_(system_.packs()),
      outcomes_(system_.slices()),
      rest_pressure_(system_.packs()) {
  first_.push_back(0);
  for (const SegmentTask& task : tasks_) {
    const auto& how = task.scene->discretisation;
    first_.push_back(first_.back() + how.slice_count);
    rules_.push_back(physics::slice_quadrature(how.slice_rule, how.slice_count));
    wall_rules_.push_back(physics::gauss_legendre(wall_points_of(task)));
  }
  energised_ = !petsc::agree(comm_, std::all_of(tasks_.begin(), tasks_.end(), [](const SegmentTask& task) {
                               return voltage_of(task) == 0;
                             }));
  newton_ = petsc::agree(comm_, std::all_of(tasks_.begin(), tasks_.end(), [](const SegmentTask& task) {
                           return task.scene->discretisation.slice_solver == model::SliceSolver::newton;
                         }));
  set_constants();
}

template <typename Action>
void SliceStudy::each_slice(Action&& action) {
  for (std::size_t t = 0; t < tasks_.size(); ++t)
    for (std::size_t slice = first_[t]; slice < first_[t + 1]; ++slice)
      action(slice, t, slice / pack_width, static_cast<int>(slice % pack_width));
}

void SliceStudy::set_constants() {
  each_slice([&](std::size_t slice, std::size_t t, std::size_t, int) {
    const model::Scene& scene = *tasks_[t].scene;
    const model::Module& module = scene.bandage.modules[tasks_[t].segment];
    const double mean_radius = scene.leg.segments[tasks_[t].segment].mean_radius();
    SliceOutcome& outcome = outcomes_[slice];
    outcome.leg_radius =
        set_slice(system_, slice, tasks_[t], rules_[t].nodes[slice - first_[t]], wall_rules_[t]);
    outcome.reference_radius = module.length > 0 ? module.length / (2 * M_PI) : mean_radius / module.stretch;
  });
}

// On a leg that does not give way; negative pressures mean no contact.
void SliceStudy::rigid_pressures() {
  for (bool on : {false, true}) {
    system_.energise(on);
    Pack strain{}, pressure, slope;
    each_slice([&](std::size_t slice, std::size_t, std::size_t pack, int place) {
      if (place == 0) physics::bandage_pressure(system_.shape(), system_.pack(pack), strain, pressure, slope);
      const double pascal =
          std::max(0.0, pressure[place]) * system_.constant(slice, SliceShape::pressure_scale);
      (on ? outcomes_[slice].pressure_actuated_rigid : outcomes_[slice].pressure_rest_rigid) = pascal;
    });
  }
}

void SliceStudy::rest(SliceSolver& solver) {
  system_.energise(false);
  Pack unused;
  solver.solve(system_, states_, [&](std::size_t k) {
    if (newton_)
      physics::start_at_rest(system_.shape(), system_.pack(k), states_[k], unused);
    else
      physics::start_fixed_point(true, states_[k]);
  });
  if (newton_) solve_doubtful(solver, true);
  record(true);
}

void SliceStudy::actuate(SliceSolver& solver) {
  system_.energise(true);
  for (std::size_t k = 0; k < system_.packs(); ++k) {
    rest_pressure_[k] = states_[k].pressure;
    newton_ ? physics::start_actuated(states_[k]) : physics::start_fixed_point(false, states_[k]);
  }
  each_slice([&](std::size_t slice, std::size_t t, std::size_t pack, int place) {
    if (voltage_of(tasks_[t]) == 0 || outcomes_[slice].status >= Status::no_equilibrium)
      states_[pack].open[place] = 0;
  });
  solver.solve(system_, states_);
  if (newton_) solve_doubtful(solver, false);
  record(false);
}

// Slices whose equation was, somewhere on the way, too flat for Newton's root to be surely the one that the
// bandage reaches: find the interval of that one, and solve again inside it.
void SliceStudy::solve_doubtful(SliceSolver& solver, bool at_rest) {
  double reopened = 0;
  each_slice([&](std::size_t slice, std::size_t t, std::size_t pack, int place) {
    PackState& state = states_[pack];
    const bool sure = at_rest && stiffens(tasks_[t].scene->bandage);
    const bool soft = !stiffens(tasks_[t].scene->bandage) || state.smallest_slope[place] < doubtful_slope;
    const double highest =
        at_rest ? system_.constant(slice, SliceShape::pressure_limit) : rest_pressure_[pack][place];
    if (sure || !soft || state.iterations[place] == 0 || !(highest > 0)) return;
    const auto found = physics::contact_interval(system_, slice, highest, at_rest);
    state.open[place] = found ? 1 : 0;
    if (found) {
      state.low[place] = std::min(found->from, found->to);
      state.high[place] = std::max(found->from, found->to);
      state.pressure[place] = 0.5 * (found->from + found->to);
      ++reopened;
    } else {
      state.pressure[place] = 0;
    }
  });
  if (petsc::sum(comm_, reopened) == 0) return;
  solver.solve(system_, states_, [&](std::size_t k) {
    // The iterates start on the leg's law.
    Pack strain, slope;
    physics::leg_strain(system_.shape(), system_.pack(k), states_[k].pressure, strain, slope);
    for (int i = 0; i < pack_width; ++i)
      if (states_[k].open[i] > 0 || states_[k].pressure[i] == 0) states_[k].strain[i] = strain[i];
  });
}

// States of the slices to outcomes.
void SliceStudy::record(bool at_rest) {
  each_slice([&](std::size_t slice, std::size_t t, std::size_t pack, int place) {
    SliceOutcome& outcome = outcomes_[slice];
    const PackState& state = states_[pack];
    const double pressure = state.pressure[place] * system_.constant(slice, SliceShape::pressure_scale);
    const double radius = outcome.leg_radius * (1 - state.strain[place]);
    const double touching = outcome.leg_radius / system_.constant(slice, SliceShape::leg_radius);  // A
    outcome.iterations = std::max(outcome.iterations, static_cast<int>(state.iterations[place]));
    if (state.open[place] > 0 || state.failed[place] > 0)
      outcome.status = std::max(outcome.status, Status::diverged);
    if (pressure > tasks_[t].scene->leg.data_limit &&
        tasks_[t].scene->leg.material == model::LegMaterial::compliance)
      outcome.status = std::max(outcome.status, Status::extrapolated);
    if (at_rest) {
      outcome.pressure_rest = pressure;
      outcome.radius_rest = radius;
      outcome.bandage_radius_rest = pressure > 0 ? radius : std::max(radius, touching);
      if (pressure == 0) outcome.status = std::max(outcome.status, Status::slack);
    }
    outcome.pressure_actuated = pressure;
    outcome.strain_actuated = state.strain[place];
    outcome.radius_actuated = radius;
    outcome.bandage_radius_actuated = pressure > 0 ? radius : std::max(radius, touching);
  });
}

// A bandage under voltage that does not touch the leg: its own equilibrium, if it has one.
void SliceStudy::float_free(std::size_t slice) {
  SliceOutcome& outcome = outcomes_[slice];
  const double start = 1 - outcome.bandage_radius_actuated / outcome.leg_radius;
  const auto strain = physics::floating_strain(system_, slice, start);
  const Status found = outcome.pressure_rest > 0 ? Status::lifted : Status::slack;
  outcome.status = std::max(outcome.status, strain ? found : Status::pulled_in);
  if (strain) outcome.bandage_radius_actuated = outcome.leg_radius * (1 - *strain);
}

// What needs the actuated radius of the bandage: lift-off, actuation pressure, field.
void SliceStudy::finish_actuated() {
  Pack strain, pressure, slope, field;
  each_slice([&](std::size_t slice, std::size_t t, std::size_t pack, int place) {
    SliceOutcome& outcome = outcomes_[slice];
    if (place == 0 || slice == 0) {
      for (int i = 0; i < pack_width; ++i) strain[i] = states_[pack].strain[i];
      for (int i = 0; i < pack_width; ++i) {
        const std::size_t other = pack * pack_width + i;
        if (other >= outcomes_.size() || outcomes_[other].status >= Status::no_equilibrium) continue;
        const std::size_t owner = std::upper_bound(first_.begin(), first_.end(), other) - first_.begin() - 1;
        if (voltage_of(tasks_[owner]) != 0 && outcomes_[other].pressure_actuated == 0) float_free(other);
        strain[i] = 1 - outcomes_[other].bandage_radius_actuated / outcomes_[other].leg_radius;
      }
      physics::actuation_pressure(system_.shape(), system_.pack(pack), strain, pressure, slope);
      physics::largest_field(system_.shape(), system_.pack(pack), strain, field);
    }
    const double inner = outcome.leg_radius / system_.constant(slice, SliceShape::leg_radius);
    outcome.actuation_pressure = pressure[place] * system_.constant(slice, SliceShape::pressure_scale);
    outcome.electric_field = field[place] * voltage_of(tasks_[t]) / inner;
  });
}

// Relative error of each task's height average, from that of the starting values, which are close to the
// pressures and cost one evaluation each: their average by the task's rule against the one by a finer rule.
std::vector<double> SliceStudy::height_errors(bool rigid) const {
  std::vector<physics::Quadrature> fine;
  std::vector<std::size_t> first{0};  // of each task: the fine slices, then those of its own rule
  for (const physics::Quadrature& rule : rules_) {
    const int count = static_cast<int>(rule.nodes.size());
    fine.push_back(physics::gauss_legendre(std::min(2 * count + 4, most_check_points)));
    first.push_back(first.back() + fine.back().nodes.size() + count);
  }
  SliceSystem system(common_shape(tasks_), first.back());
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    std::size_t slice = first[t];
    for (double height : fine[t].nodes) set_slice(system, slice++, tasks_[t], height, wall_rules_[t]);
    for (double height : rules_[t].nodes) set_slice(system, slice++, tasks_[t], height, wall_rules_[t]);
  }
  std::vector<double> errors(tasks_.size(), smallest_error);
  for (bool on : {false, true}) {
    system.energise(on);
    std::vector<PackState> start(system.packs());
    for (std::size_t k = 0; k < system.packs(); ++k) {
      Pack pressure;
      physics::start_at_rest(system.shape(), system.pack(k), start[k], pressure);
      if (rigid)
        for (int i = 0; i < pack_width; ++i) start[k].pressure[i] = std::max(0.0, pressure[i]);
    }
    for (std::size_t t = 0; t < tasks_.size(); ++t) {
      std::size_t slice = first[t];
      const auto mean = [&](const physics::Quadrature& rule) {
        double sum = 0;
        for (double weight : rule.weights) {
          sum += weight * start[slice / pack_width].pressure[slice % pack_width];
          ++slice;
        }
        return sum;
      };
      const double finer = mean(fine[t]), own = mean(rules_[t]);
      if (finer > 0) errors[t] = std::max(errors[t], caution * std::fabs(own / finer - 1));
    }
  }
  return errors;
}

std::vector<model::SegmentResult> SliceStudy::run() {
  rigid_pressures();
  const model::Scene* scene = tasks_.empty() ? nullptr : tasks_[0].scene;
  const bool rigid = petsc::largest(comm_, scene && (scene->fidelity == model::Fidelity::rigid ||
                                                     scene->leg.model == model::LegModel::rigid)) > 0;
  if (rigid) {
    each_slice([&](std::size_t slice, std::size_t, std::size_t pack, int place) {
      SliceOutcome& outcome = outcomes_[slice];
      states_[pack].strain[place] = 0;
      const double touching = outcome.leg_radius / system_.constant(slice, SliceShape::leg_radius);
      outcome.pressure_rest = outcome.pressure_rest_rigid;
      outcome.pressure_actuated = outcome.pressure_actuated_rigid;
      outcome.radius_rest = outcome.radius_actuated = outcome.leg_radius;
      outcome.bandage_radius_rest = outcome.bandage_radius_actuated =
          outcome.pressure_rest > 0 ? outcome.leg_radius : std::max(outcome.leg_radius, touching);
      if (outcome.pressure_rest == 0) outcome.status = Status::slack;
    });
  } else {
    const double tolerance = petsc::largest(comm_, scene ? scene->discretisation.fixed_point_tolerance : 0);
    SliceSolver solver(comm_, system_.packs(),
                       newton_ ? model::SliceSolver::newton : model::SliceSolver::fixed_point, tolerance);
    rest(solver);
    if (energised_) actuate(solver);
  }
  system_.energise(true);
  if (energised_) finish_actuated();

  const std::vector<double> errors = height_errors(rigid);
  std::vector<model::SegmentResult> results;
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    const model::Scene& own = *tasks_[t].scene;
    const double error = errors[t] + physics::wall_error(own, tasks_[t].segment,
                                                         static_cast<int>(wall_rules_[t].nodes.size()));
    results.push_back(physics::summarise(std::span(outcomes_).subspan(first_[t], first_[t + 1] - first_[t]),
                                         rules_[t], own.leg.segments[tasks_[t].segment].height, error));
    results.back().fidelity = rigid ? model::Fidelity::rigid : model::Fidelity::slice;
  }
  return results;
}

}  // namespace

std::vector<model::SegmentResult> solve_segments(MPI_Comm comm, std::span<const SegmentTask> tasks) {
  return SliceStudy(comm, tasks).run();
}

}  // namespace gaiter::solvers
