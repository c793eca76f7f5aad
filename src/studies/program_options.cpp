// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/option_table.hpp"

namespace gaiter::studies {

std::vector<Option> program_options() {
  return {
      {.name = "comparison",
       .kind = Kind::choice,
       .scope = Scope::program,
       .choices = {"none", "paper"},
       .default_text = "none",
       .doc = "Print the paper's printed results beside the computed ones."},
      {.name = "dry_run",
       .kind = Kind::flag,
       .scope = Scope::program,
       .default_text = "false",
       .doc = "Print the resolved scene, every default included, and stop."},
      {.name = "help",
       .kind = Kind::text,
       .scope = Scope::program,
       .format = "nothing, or markdown",
       .example = "markdown",
       .doc = "List commands and options, and stop."},
      {.name = "leg_segments",
       .kind = Kind::text,
       .scope = Scope::program,
       .count = {1, 100000},
       .format = "names of letters, digits and _, ankle up",
       .example = "r6,r5,r4,r3,r2,r1",
       .doc = "Names of the leg's segments; each one has a bandage module."},
      {.name = "options_file",
       .kind = Kind::text,
       .scope = Scope::program,
       .format = "a YAML file",
       .example = "options/scenes/paper.yaml",
       .doc = "Options from a file, nested keys joined by _; the command line wins."},
      {.name = "output",
       .kind = Kind::text,
       .scope = Scope::program,
       .format = "a file name",
       .default_text = "gaiter.h5",
       .doc = "Archive to write (HDF5)."},
      {.name = "output_variables",
       .kind = Kind::text,
       .scope = Scope::program,
       .format = "all, or names of results as in the archive",
       .default_text = "all",
       .example = "pressure_rest,volume_change",
       .doc = "Results that the archive keeps; status is always among them."},
      {.name = "progress",
       .kind = Kind::choice,
       .scope = Scope::program,
       .choices = {"auto", "line", "log", "off"},
       .default_text = "auto",
       .doc =
           "How a sweep tells on stderr how far it is: on one line that is written over, in lines at growing "
           "intervals, or not at all; auto is line on a terminal and log elsewhere. off also leaves out the "
           "summary of the run's speed.",
       .commands = {Command::sweep}},
      {.name = "sweep_<option>",
       .kind = Kind::text,
       .scope = Scope::program,
       .format = "a list, linspace(lo,hi,n), logspace(lo,hi,n), uniform(lo,hi) or normal(mean,sd)",
       .example = "1.4,1.6,1.8",
       .doc =
           "Values of one option to sweep, each one that the option itself allows. One number of an option "
           "of several is named, as in sweep_leg_<s>_radius_lower or sweep_bandage_ogden_mu_1.",
       .commands = {Command::sweep}},
      {.name = "sweep_sampler",
       .kind = Kind::choice,
       .scope = Scope::program,
       .choices = {"grid", "sobol", "random"},
       .default_text = "grid",
       .doc = "How swept options combine: every value with every other, the points of a Sobol sequence, or "
              "random ones. The latter two draw one value of each option for each design.",
       .commands = {Command::sweep}},
      {.name = "sweep_samples",
       .kind = Kind::count,
       .scope = Scope::program,
       .components = {{.range = {.low = 1, .high = 1e15}}},
       .example = "1000",
       .doc = "Designs of the samplers sobol and random.",
       .commands = {Command::sweep}},
      {.name = "sweep_seed",
       .kind = Kind::count,
       .scope = Scope::program,
       .components = {{.range = {.low = 0, .high = 1e15}}},
       .default_text = "0",
       .doc =
           "Another number gives other random designs. Sobol's sequence is the plain one with 0, else it is "
           "shifted at random.",
       .commands = {Command::sweep}},
  };
}

}  // namespace gaiter::studies
