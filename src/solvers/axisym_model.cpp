// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "gaiter/petsc/check.hpp"
#include "gaiter/physics/slice_system.hpp"
#include "gaiter/solvers/axisym_solver.hpp"
#include "gaiter/solvers/axisym_start.hpp"

namespace gaiter::solvers {

namespace {

using model::Status;

constexpr double vacuum_permittivity = 8.8541878128e-12;  // [F/m]
constexpr double weakest_spring = 1e-3;  // of the path to the frictionless state, of the shear modulus
constexpr double strongest_spring = 10;
constexpr int most_path_steps = 40;
constexpr double end_zone =
    0.1;  // of the height, at either end, where pressures are not looked at one by one

// Initial shear modulus of the elastomer: the problem's unit of stress.
double shear_modulus(const model::Bandage& bandage) {
  double sum = 0;
  for (const auto& term : bandage.ogden) sum += 0.5 * term.mu * term.alpha;
  return sum;
}

// What a converged state says of a segment, lengths and stresses over the problem's units.
struct StateSummary {
  bool converged = false, stable = true;
  int iterations = 0;
  double pressure = 0, pressure_area = 0, volume = 0, radius = 0, stretch = 0, slip = 0, field = 0,
         maxwell = 0;
  double highest_pressure = 0;
  bool open_somewhere = false, open_everywhere = false;
};

template <int P>
class AxisymCase {
 public:
  AxisymCase(MPI_Comm comm, const model::Scene& scene, std::size_t segment, int refine)
      : scene_(scene),
        segment_(segment),
        module_(scene.bandage.modules[segment]),
        unit_(shear_modulus(scene.bandage)) {
    AxisymResolution resolution;
    resolution.refinements = refine;
    AxisymMesh mesh = make_axisym_mesh(scene, segment, segment, resolution);
    length_ = mesh.length;
    const bool held = scene.contact_axial == model::ContactAxial::held;
    auto space = AxisymSpace<P>::make(comm, std::move(mesh),
                                      scene.axisym.multipliers == model::ContactSide::tube, held);
    system_ = std::make_unique<AxisymSystem<P>>(comm, std::move(space), materials());
    solver_ = std::make_unique<AxisymSolver<P>>(*system_);
    petsc::check(DMCreateGlobalVector(system_->space().plex.get(), x_.out()));
    petsc::check(VecDuplicate(x_.get(), kept_.out()));
  }

  StateSummary rest() {
    petsc::check(set_slice_start<P>(*system_, states(false), x_.get()));
    AxisymReport report = solver_->solve(x_.get());
    int iterations = report.iterations;
    if (!good(report)) report = follow_spring(iterations);
    return summarise(report, iterations, false);
  }

  // One linear solve at the start.
  void try_solver() {
    petsc::check(set_slice_start<P>(*system_, states(false), x_.get()));
    solver_->try_at(x_.get());
  }

  // From the state at rest, which x holds.
  StateSummary actuated() {
    if (scene_.axisym.electrostatics == model::Electrostatics::off) return summarise({true}, 0, false);
    const auto full = radial_field<P>(scene_, *system_, states(true));
    int iterations = 0;
    // The field enters squared: equal steps of its square.
    double reached = 0, step = 1;
    AxisymReport report;
    for (int k = 0; reached < 1 && k < most_path_steps && step > 1e-3; ++k) {
      petsc::check(VecCopy(x_.get(), kept_.get()));
      const double target = std::min(1.0, reached + step);
      set_field(full, std::sqrt(target));
      report = solver_->solve(x_.get());
      iterations += report.iterations;
      if (good(report)) {
        reached = target;
      } else {
        petsc::check(VecCopy(kept_.get(), x_.get()));
        step *= 0.5;
      }
    }
    report.converged = reached == 1;
    return summarise(report, iterations, true);
  }

 private:
  using Element = physics::AxisymElement<P>;

  static bool good(const AxisymReport& report) { return report.converged && report.stable; }

  AxisymMaterials materials() const {
    AxisymMaterials result;
    result.stress = unit_;
    for (const auto& term : scene_.bandage.ogden) result.tube.ogden.push_back({term.mu / unit_, term.alpha});
    result.tube.bulk_modulus = scene_.bandage.bulk_modulus / unit_;
    result.tube.stabilisation = 1;
    result.tube.permittivity = vacuum_permittivity * scene_.bandage.permittivity * module_.voltage *
                               module_.voltage / (length_ * length_ * unit_);
    for (const model::Segment& segment : scene_.leg.segments) {
      physics::LegMaterialLaw law = physics::leg_material(scene_.leg, segment);
      law.shear_modulus /= unit_;
      law.bulk_modulus /= unit_;
      law.b *= unit_;
      law.d *= unit_;
      result.leg.push_back(law);
    }
    return result;
  }

  std::vector<RadialState> states(bool actuated) const {
    std::vector<RadialState> result;
    const auto add = [&](const ContactSurface& surface) {
      std::vector<double> heights;
      for (const SurfaceNode& node : surface.nodes)
        heights.push_back(node.height * length_ / scene_.leg.segments[segment_].height);
      result.push_back(slice_states(scene_, segment_, heights, actuated));
    };
    add(system_->space().tubes[0]);
    add(system_->space().leg);
    return result;
  }

  void set_field(std::vector<typename Element::Field> field, double factor) {
    for (auto& cell : field)
      for (auto& gradient : cell)
        for (double& component : gradient) component *= factor;
    system_->set_field(std::move(field));
  }

  // From the tube held at its heights, where the slices are all but right, to the free one.
  AxisymReport follow_spring(int& iterations) {
    petsc::check(set_slice_start<P>(*system_, states(false), x_.get()));
    petsc::check(VecCopy(x_.get(), kept_.get()));
    AxisymReport report;
    double spring = strongest_spring, factor = 0.25;
    bool released = false, reached = false;
    for (int k = 0; k < most_path_steps && !released; ++k) {
      system_->set_axial_spring(spring);
      report = solver_->solve(x_.get());
      iterations += report.iterations;
      if (good(report)) {
        released = spring == 0;
        reached = true;
        petsc::check(VecCopy(x_.get(), kept_.get()));
        last_spring_ = spring;
        spring = spring * factor > weakest_spring ? spring * factor : 0;
      } else {
        if (!reached || factor > 0.98) break;
        petsc::check(VecCopy(kept_.get(), x_.get()));
        factor = std::sqrt(factor);
        spring = last_spring_ * factor;
      }
    }
    system_->set_axial_spring(0);
    report.converged = released;
    report.stable = released || !reached;  // a path that ends on the way: the free tube has no equilibrium
    return report;
  }

  // Value and slope of a nodal quantity on an edge.
  static std::array<double, 2> at(const std::vector<double>& values, std::size_t edge, double place) {
    const auto& c = physics::lagrange_coefficients<P>();
    double value = 0, slope = 0;
    for (int k = P; k >= 0; --k) {
      double coefficient = 0;
      for (int i = 0; i <= P; ++i) coefficient += c[i][k] * values[P * edge + i];
      slope = slope * place + value;
      value = value * place + coefficient;
    }
    return {value, slope};
  }

  StateSummary summarise(const AxisymReport& report, int iterations, bool energised) const {
    using Surface = typename AxisymSystem<P>::SurfaceState;
    StateSummary sum{report.converged, report.stable, iterations};
    if (!report.converged) return sum;
    static const physics::Quadrature rule = physics::gauss_legendre(P + 2);
    const auto integrate = [&](const Surface& surface, auto&& integrand) {
      double total = 0;
      for (std::size_t edge = 0; P * edge + P < surface.radius.size(); ++edge)
        for (std::size_t g = 0; g < rule.nodes.size(); ++g) {
          const double x = rule.nodes[g];
          const double pressure =
              (1 - x) * surface.multiplier[P * edge] + x * surface.multiplier[P * (edge + 1)];
          total += rule.weights[g] *
                   integrand(edge, x, at(surface.radius, edge, x), at(surface.height, edge, x), pressure);
        }
      return total;
    };
    using Pair = std::array<double, 2>;
    const Surface &tube = system_->tubes()[0], &leg = system_->leg();
    const Surface& carrier = system_->space().multipliers_on_tube ? tube : leg;
    const double height = scene_.leg.segments[segment_].height / length_;
    sum.pressure =
        integrate(carrier, [](std::size_t, double, Pair, Pair z, double p) { return p * z[1]; }) / height;
    const double force = integrate(carrier, [](std::size_t, double, Pair r, Pair z, double p) {
      return p * r[0] * std::hypot(r[1], z[1]);
    });
    const double face = integrate(
        tube, [](std::size_t, double, Pair r, Pair z, double) { return r[0] * std::hypot(r[1], z[1]); });
    sum.pressure_area = force / face;
    sum.volume =
        integrate(leg, [](std::size_t, double, Pair r, Pair z, double) { return M_PI * r[0] * r[0] * z[1]; });
    sum.radius =
        integrate(leg, [](std::size_t, double, Pair r, Pair z, double) { return r[0] * z[1]; }) / height;
    const double reference = module_.length > 0
                                 ? module_.length / (2 * M_PI) / length_
                                 : scene_.leg.segments[segment_].mean_radius() / module_.stretch / length_;
    sum.stretch = integrate(tube, [](std::size_t, double, Pair r, Pair z, double) { return r[0] * z[1]; }) /
                  height / reference;
    const auto& nodes = system_->space().tubes[0].nodes;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      sum.slip = std::max(sum.slip, std::fabs(tube.height[i] - nodes[i].height));
    std::size_t vertices = 0, active = 0;
    for (std::size_t i = 0; i < carrier.active.size(); i += P, ++vertices) {
      active += carrier.active[i];
      // Away from the ends, whose peaks are singular and grow with the mesh.
      const double place = carrier.height[i] / height;
      if (carrier.active[i] && place > end_zone && place < 1 - end_zone)
        sum.highest_pressure = std::max(sum.highest_pressure, carrier.multiplier[i]);
    }
    sum.open_somewhere = active < vertices;
    sum.open_everywhere = active == 0;
    if (energised) {
      // Eq. (8) and the field at the inner faces of the layers, the wall thinned by its axial stretch as
      // well.
      const double A = nodes[0].radius, wall = scene_.bandage.thickness / length_;
      const int layers = scene_.bandage.layers;
      const double strength = system_->materials().tube.permittivity;
      sum.maxwell = integrate(tube,
                              [&](std::size_t edge, double x, Pair r, Pair z, double) {
                                const double reference_slope = reference_height_slope(edge, x),
                                             axial = z[1] / reference_slope;
                                double total = 0;
                                for (int k = 0; k < layers; ++k) {
                                  const double inner = A + wall * k / layers,
                                               outer = A + wall * (k + 1) / layers;
                                  const double low = r[0] * r[0] + (inner - A) * (inner + A) / axial;
                                  const double high = r[0] * r[0] + (outer - A) * (outer + A) / axial;
                                  const double q = (high - low) / low, log_q = std::log1p(q);
                                  total += 2 * strength * q / (high * log_q * log_q);
                                  sum.field = std::max(sum.field, 2 / (std::sqrt(low) * log_q));
                                }
                                return total * z[1];
                              }) /
                    height;
    }
    return sum;
  }

  double reference_height_slope(std::size_t edge, double place) const {
    std::vector<double> heights;
    for (int i = 0; i <= P; ++i) heights.push_back(system_->space().tubes[0].nodes[P * edge + i].height);
    return at(heights, 0, place)[1];
  }

  const model::Scene& scene_;
  std::size_t segment_;
  const model::Module& module_;
  double unit_, length_ = 1;
  double last_spring_ = 0;
  std::unique_ptr<AxisymSystem<P>> system_;
  std::unique_ptr<AxisymSolver<P>> solver_;
  petsc::Vector x_, kept_;
};

struct Solved {
  StateSummary rest, actuated;
};

template <int P>
Solved solve_states(MPI_Comm comm, const SegmentTask& task, int refine) {
  AxisymCase<P> problem(comm, *task.scene, task.segment, refine);
  Solved solved;
  solved.rest = problem.rest();
  const bool voltage = task.scene->bandage.modules[task.segment].voltage != 0;
  solved.actuated = voltage && solved.rest.converged ? problem.actuated() : solved.rest;
  return solved;
}

Solved solve_states(MPI_Comm comm, const SegmentTask& task, int refine) {
  switch (task.scene->axisym.order) {
    case 3:
      return solve_states<3>(comm, task, refine);
    case 4:
      return solve_states<4>(comm, task, refine);
    default:
      return solve_states<2>(comm, task, refine);
  }
}

Status status_of(const Solved& solved, const model::Scene& scene, double unit) {
  const auto failure = [](const StateSummary& state) {
    return state.stable ? Status::diverged : Status::no_equilibrium;
  };
  if (!solved.rest.converged) return failure(solved.rest);
  if (!solved.actuated.converged) return failure(solved.actuated);
  const double highest = std::max(solved.rest.highest_pressure, solved.actuated.highest_pressure) * unit;
  if (scene.leg.material == model::LegMaterial::compliance && highest > scene.leg.data_limit)
    return Status::extrapolated;
  if (solved.rest.open_everywhere) return Status::slack;
  if (solved.actuated.open_everywhere) return Status::lifted;
  return Status::contact;
}

model::SegmentResult solve_task(MPI_Comm comm, const SegmentTask& task) {
  const model::Scene& scene = *task.scene;
  const model::Segment& segment = scene.leg.segments[task.segment];
  const double unit = shear_modulus(scene.bandage), length = segment.mean_radius();
  const int refine = scene.axisym.refine;
  const Solved fine = solve_states(comm, task, refine);

  // The pressures on a rigid leg are the slices'; so are those that nothing else gives.
  model::Scene slices = scene;
  slices.fidelity = model::Fidelity::rigid;
  const SegmentTask rigid_task{&slices, task.segment};
  const model::SegmentResult rigid = solve_segments(PETSC_COMM_SELF, {&rigid_task, 1})[0];

  model::SegmentResult result;
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  result.fidelity = model::Fidelity::axisym;
  result.status = status_of(fine, scene, unit);
  result.iterations = std::max(fine.rest.iterations, fine.actuated.iterations);
  result.pressure_rest_rigid = rigid.pressure_rest_rigid;
  result.pressure_actuated_rigid = rigid.pressure_actuated_rigid;
  result.volume_initial = rigid.volume_initial;
  const bool good = model::trustworthy(result.status);
  const auto put = [&](double value) { return good ? value : none; };
  const double volume = length * length * length;
  result.pressure_rest = put(fine.rest.pressure * unit);
  result.pressure_actuated = put(fine.actuated.pressure * unit);
  result.pressure_rest_area_mean = put(fine.rest.pressure_area * unit);
  result.pressure_actuated_area_mean = put(fine.actuated.pressure_area * unit);
  model::derive_changes(result);
  result.actuation_pressure = put(fine.actuated.maxwell * unit);
  result.volume_rest = put(fine.rest.volume * volume);
  result.volume_actuated = put(fine.actuated.volume * volume);
  result.volume_change = (result.volume_initial - result.volume_actuated) / result.volume_initial;
  result.radius_actuated = put(fine.actuated.radius * length);
  result.stretch_actual = put(fine.rest.stretch);
  result.slip_max = put(std::max(fine.rest.slip, fine.actuated.slip) * length);
  result.electric_field_max = put(fine.actuated.field * scene.bandage.modules[task.segment].voltage / length);
  result.error_estimate = none;
  if (good && refine > 0) {
    const Solved coarse = solve_states(comm, task, refine - 1);
    const auto change = [](double a, double b) { return b != 0 ? std::fabs(a / b - 1) : 0; };
    if (coarse.rest.converged && coarse.actuated.converged)
      result.error_estimate = std::max(change(coarse.rest.pressure, fine.rest.pressure),
                                       change(coarse.actuated.pressure, fine.actuated.pressure));
  }
  return result;
}

}  // namespace

std::vector<model::SegmentResult> solve_axisym(MPI_Comm comm, std::span<const SegmentTask> tasks) {
  std::vector<model::SegmentResult> results;
  for (const SegmentTask& task : tasks) results.push_back(solve_task(comm, task));
  return results;
}

void try_axisym(MPI_Comm comm, const SegmentTask& task) {
  AxisymCase<2>(comm, *task.scene, task.segment, 0).try_solver();
}

}  // namespace gaiter::solvers
