// SPDX-License-Identifier: BSD-2-Clause
// The slice model at the extremes, against 50 digits: one table. Options: -draws N (a line, default 60),
// -line TEXT (lines whose name has it), -worst (shows each line's worst case).
#include <fmt/core.h>

#include <array>
#include <string>

#include "extremes_systems.hpp"
#include "gaiter/petsc/session.hpp"

namespace {

using namespace gaiter;

const char* const statuses[] = {"contact",   "slack",          "lifted",   "extrapolated",
                                "pulled_in", "no_equilibrium", "diverged", "invalid"};

std::string describe(const model::Scene& scene) {
  const auto& law = scene.leg.segments[0].compliance;
  std::string text = fmt::format(
      "stretch {:.17g} wall {:.17g} at {} radius {:.17g} V {:.17g} layers {} leg {}/{} {} {} {} {} E {} nu "
      "{}",
      scene.bandage.modules[0].stretch, scene.bandage.thickness, static_cast<int>(scene.bandage.length_at),
      scene.leg.segments[0].lower_radius, scene.bandage.modules[0].voltage, scene.bandage.layers,
      static_cast<int>(scene.leg.material), static_cast<int>(scene.leg.variant), law.a, law.b, law.c, law.d,
      scene.leg.young_modulus, scene.leg.poisson_ratio);
  for (const auto& term : scene.bandage.ogden) text += fmt::format(" ogden {} {}", term.mu, term.alpha);
  return text;
}

void print_line(const extremes::Line& line, int draws, bool show) {
  samples::Sampler sampler(1);
  std::array<int, model::status_count> met{};
  extremes::Finding furthest, worst;
  std::string worst_scene, notes;
  int cases = 0, wrong = 0, beyond = 0;
  for (int draw = 0; cases < draws && draw < 50 * draws; ++draw) {
    const auto made = line.draw(sampler, cases);
    if (!made) continue;
    ++cases;
    const auto finding = extremes::compare(*made);
    ++met[static_cast<std::size_t>(finding.status)];
    if (!finding.same_status) {
      ++wrong;
      notes += fmt::format("  status {}, should be {}: {}\n", statuses[static_cast<int>(finding.status)],
                           statuses[static_cast<int>(finding.expected)], describe(made->scene));
    }
    if (finding.pressure_error > finding.estimate) {
      ++beyond;
      notes += fmt::format("  error {:.2e} estimate {:.2e}: {}\n", finding.pressure_error, finding.estimate,
                           describe(made->scene));
    }
    if (finding.error > furthest.error) furthest = finding;
    if (finding.amplification > worst.amplification) worst = finding, worst_scene = describe(made->scene);
  }
  std::string found;
  for (std::size_t i = 0; i < met.size(); ++i)
    if (met[i] > 0) found += fmt::format("{}{} {}", found.empty() ? "" : ", ", met[i], statuses[i]);
  fmt::print("| {} | {} | {} | {:.1e} | {:.1e} | {:.1f} ({}) | {} | {} | {} |\n", line.quantity, line.range,
             cases, furthest.error, furthest.condition, worst.amplification,
             reference::output_names[worst.output], beyond, wrong, found);
  if (show) fmt::print("  {}\n{}", worst_scene, notes);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  int draws = 60;
  bool show = false;
  std::string only;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "-draws" && i + 1 < argc) draws = std::stoi(argv[++i]);
    if (word == "-line" && i + 1 < argc) only = argv[++i];
    if (word == "-worst") show = true;
  }
  petsc::Session session({});
  fmt::print(
      "| quantity | range | cases | largest relative error | its condition | error / (condition x eps) | "
      "beyond estimate | wrong status | statuses |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& line : extremes::lines())
    if (line.quantity.find(only) != std::string::npos) print_line(line, draws, show);
  if (!only.empty()) return 0;
  const auto units = extremes::compare_units();
  fmt::print(
      "units from um to km, mPa to MPa, mV to MV: values of a scene within {} ulp, results within {:.1f} "
      "times their condition number times eps\n",
      units.ulps, units.amplification);
  const auto many = extremes::solve_many(0, 1000000, 200);
  fmt::print(
      "1e6 slices in one system: {} unsolved; of {} the largest error of the pressure is {:.1e}, {} have "
      "other bits than alone\n",
      many.unsolved, many.sampled, many.error, many.other_bits);
}
