// SPDX-License-Identifier: BSD-2-Clause
// Many random command lines through the whole program in one process, options to archive:
//   fuzz [--scenes 400] [--seed 1] [--from 0] [--axisym]
// Each must end with an exit code of 0, 2 or 3 in bounded time. With 2 nothing is written and one line names
// an option; else every number in the archive that its status vouches for is finite and makes sense, and
// single slices are in equilibrium by the reference's own equations.
#include <fcntl.h>
#include <fmt/core.h>
#include <petscsys.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>

#include "fuzz_scenes.hpp"
#include "gaiter/archive/reader.hpp"
#include "gaiter/base/error.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/studies/program.hpp"
#include "gaiter/studies/scene_options.hpp"
#include "reference.hpp"

namespace {

using namespace gaiter;
using reference::Quick;
using reference::Real;

constexpr unsigned seconds_allowed = 40;  // a scene; the machine may be busy
unsigned current = 0;
std::string current_words;

void die(int signal) {
  char text[80];
  const int size = std::snprintf(text, sizeof text, "scene %u ended by signal %d\n", current, signal);
  (void)!write(STDERR_FILENO, text, static_cast<std::size_t>(size));
  (void)!write(STDERR_FILENO, current_words.data(), std::min<std::size_t>(current_words.size(), 3000));
  _exit(1);
}

struct Outcome {
  int code = 0;
  std::string message;    // of exit code 2
  std::string complaint;  // what is wrong; empty: nothing
};

// The command line as src/gaiter.cpp takes it.
Outcome run(petsc::Session& session, const std::vector<std::string>& words) {
  std::vector<const char*> argv{"gaiter", "solve"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  Outcome outcome;
  (void)PetscOptionsClear(nullptr);
  try {
    studies::CommandLine line = studies::split_command_line(static_cast<int>(argv.size()), argv.data());
    std::vector<char*> others{const_cast<char*>("gaiter")};
    for (std::string& word : line.others) others.push_back(word.data());
    others.push_back(nullptr);
    int count = static_cast<int>(others.size()) - 1;
    char** values = others.data();
    if (PetscOptionsInsert(nullptr, &count, &values, nullptr) != 0)
      throw base::InputError("PETSc refuses the options -");
    outcome.code = studies::run_program(session, line);
  } catch (const base::InputError& error) {
    outcome.code = studies::wrong_input;
    outcome.message = error.what();
  } catch (const std::exception& error) {
    outcome.code = studies::internal_failure;
    outcome.complaint = error.what();
  }
  return outcome;
}

bool names_an_option(const std::string& message, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    if (word.size() > 1 && word[0] == '-' && message.find(word) != std::string::npos) return true;
  for (const studies::Option& option : studies::option_table()) {
    const auto name = option.name.substr(0, option.name.find('<'));
    if (message.find("-" + std::string(name)) != std::string::npos) return true;
  }
  return message.find("belongs to no option") != std::string::npos;
}

// A single slice's pressure against the printed equations.
std::string imbalance_of(const model::Scene& scene, double pressure, double voltage, double estimate) {
  const auto slice = reference::slice_of(scene, 0, 0.5);
  const auto residual = [&](auto parameter) {
    return reference::imbalance<decltype(parameter)>(slice, parameter, decltype(parameter)(voltage));
  };
  if (pressure == 0) {
    // A bandage that is wider than the leg does not touch it, whatever a compressed tube would do.
    if (voltage != 0 || slice.tube.inner >= reference::leg_at<Real>(slice, 0).radius) return "";
    const Real excess = residual(Real(0));
    return excess < Real("-1e-9") * Real(scene.bandage.ogden[0].mu > 0 ? scene.bandage.ogden[0].mu : 1e3)
               ? "no contact, though the bandage presses on the free leg"
               : "";
  }
  const Real p = pressure, off = residual(p),
             slope = (residual(Real(p * (1 + Real("1e-12")))) - off) / (p * Real("1e-12"));
  const Real allowed = fabs(slope) * p * Real(10 * estimate + 1e-9) + p * Real(1e-9);
  return fabs(off) > allowed
             ? fmt::format("pressure {} is off by {:.3g} of the balance, slope {:.3g}, estimate {}", pressure,
                           static_cast<double>(off), static_cast<double>(slope), estimate)
             : "";
}

bool of_rigid_leg(const std::string& name) {
  return name.ends_with("_rigid") || name.ends_with("_rest_change") || name.ends_with("_actuated_change");
}

std::string check_archive(const std::string& path, int code, const std::vector<std::string>& words) {
  const archive::Archive found = archive::read_archive(path);
  const auto& status = found.variables.at("status").numbers;
  const bool sliding = std::find(words.begin(), words.end(), "sliding") != words.end();
  bool trusted = true;
  for (std::size_t row = 0; row < status.size(); ++row) {
    const auto here = static_cast<model::Status>(static_cast<int>(status[row]));
    trusted = trusted && model::trustworthy(here);
    for (const auto& [name, variable] : found.variables) {
      if (variable.numbers.size() != status.size() || name == "wall_time" || name == "status") continue;
      const double value = variable.numbers[row];
      // Without friction a leg that does not give way may have no equilibrium where a soft one has.
      const bool may_be_missing = name == "voltage_stable" || name == "model_error" ||
                                  name.starts_with("planned_") || (sliding && of_rigid_leg(name)) ||
                                  (here == model::Status::pulled_in &&
                                   (name == "electric_field_max" || name == "actuation_pressure"));
      if (!model::trustworthy(here) || (may_be_missing && std::isnan(value))) continue;
      if (name == "radius_actuated" && value <= 0) return "a radius that is not positive";
      if (!std::isfinite(value)) return fmt::format("{} is {} with status {}", name, value, status[row]);
      const bool positive = name.starts_with("pressure") && name.find("change") == std::string::npos;
      if ((positive || name.ends_with("estimate") || name.starts_with("volume_r") ||
           name == "radius_actuated" || name == "electric_field_max") &&
          value < 0)
        return fmt::format("{} is {} with status {}", name, value, status[row]);
    }
  }
  if (trusted != (code == studies::success))
    return fmt::format("exit code {} does not tell of the statuses", code);
  std::map<std::string, std::string> given;
  for (std::size_t i = 0; i < words.size(); ++i)
    if (words[i][0] == '-' && words[i].size() > 1 && std::isalpha(static_cast<unsigned char>(words[i][1])))
      given[words[i].substr(1)] = i + 1 < words.size() && words[i + 1][0] != '-' ? words[i + 1] : "";
  try {
    const model::Scene scene = studies::parse_request(studies::Command::solve, given).scene;
    const auto& segment = scene.leg.segments[0];
    const bool alone = segment.lower_radius == segment.upper_radius && scene.leg.segments.size() == 1;
    if (!alone || scene.fidelity != model::Fidelity::slice || scene.leg.model == model::LegModel::rigid ||
        scene.leg.material != model::LegMaterial::compliance || status[0] >= 4)
      return "";
    const auto value = [&](const char* name) { return found.variables.at(name).numbers[0]; };
    const std::string rest = imbalance_of(scene, value("pressure_rest"), 0, value("error_estimate"));
    if (!rest.empty()) return "at rest: " + rest;
    const double voltage = scene.bandage.modules[0].voltage;
    const std::string later =
        imbalance_of(scene, value("pressure_actuated"), voltage, value("error_estimate"));
    return later.empty() ? "" : "under voltage: " + later;
  } catch (const base::InputError&) {
    return "";  // values that begin with a minus are not rebuilt here
  }
}

}  // namespace

int main(int argc, char** argv) {
  unsigned scenes = 400, seed = 1, from = 0;
  bool axisym = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--axisym") axisym = true;
    if (i + 1 >= argc) continue;
    if (word == "--scenes") scenes = static_cast<unsigned>(std::stoul(argv[++i]));
    if (word == "--seed") seed = static_cast<unsigned>(std::stoul(argv[++i]));
    if (word == "--from") from = static_cast<unsigned>(std::stoul(argv[++i]));
  }
  petsc::Session session({});
  std::string folder = std::filesystem::temp_directory_path() / "gaiter_fuzz_XXXXXX";
  if (!mkdtemp(folder.data())) return 1;
  const std::string path = folder + "/x.h5";
  std::fflush(stdout);
  const int shown = dup(STDOUT_FILENO);
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);  // the program's tables
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGALRM}) std::signal(signal, die);

  std::map<int, int> codes;
  int wrong = 0;
  for (unsigned number = from; number < from + scenes; ++number) {
    current = number;
    fuzz::Draw draw(seed, number);
    auto line = fuzz::command_line(draw, axisym);
    line.words.insert(line.words.end(), {"-output", path});
    current_words = "gaiter solve";
    for (const std::string& word : line.words) current_words += " '" + word.substr(0, 200) + "'";
    current_words += "\n";
    alarm(seconds_allowed);
    Outcome outcome = run(session, line.words);
    const bool written = !std::filesystem::is_empty(folder);
    if (outcome.complaint.empty() && outcome.code == studies::wrong_input) {
      if (written) outcome.complaint = "wrong input, but a file was written";
      if (outcome.message.find('\n') != std::string::npos) outcome.complaint = "a message of several lines";
      if (!names_an_option(outcome.message, line.words)) outcome.complaint = "the message names no option";
    } else if (outcome.complaint.empty() &&
               (outcome.code == studies::success || outcome.code == studies::untrustworthy)) {
      outcome.complaint = written ? check_archive(path, outcome.code, line.words) : "no archive was written";
    } else if (outcome.complaint.empty()) {
      outcome.complaint = "exit code";
    }
    ++codes[outcome.code];
    for (const auto& entry : std::filesystem::directory_iterator(folder)) std::filesystem::remove_all(entry);
    if (outcome.complaint.empty()) continue;
    ++wrong;
    dprintf(shown, "scene %u, exit code %d: %s\n  %s\n  %s", number, outcome.code, outcome.complaint.c_str(),
            outcome.message.substr(0, 300).c_str(), current_words.c_str());
  }
  alarm(0);
  std::filesystem::remove_all(folder);
  std::string counted;
  for (const auto& [code, count] : codes) counted += fmt::format(", {} with exit code {}", count, code);
  dprintf(shown, "%u scenes of seed %u%s; %d wrong\n", scenes, seed, counted.c_str(), wrong);
  return wrong > 0 ? 1 : 0;
}
