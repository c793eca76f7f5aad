// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/option_table.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
namespace gaiter::studies {

namespace {

using model::Scene;
using Values = std::span<const double>;

// The ranges keep out slips of unit and sign; they admit every extreme the solver is tested at.
constexpr Range radii{.low = 1e-4, .high = 10};
constexpr Range stretches{.low = 1e-3, .high = 20};
constexpr Range scales{.low = 0.01, .high = 100};
constexpr Range voltages{.low = 0, .high = 1e9};
constexpr Range positive{.low = 0, .low_open = true, .high_open = true};
constexpr Range positive_or_infinite{.low = 0, .low_open = true};

std::vector<Option> make_table() {
  return {
      {.name = "accuracy",
       .components = {{.range = {.low = 1e-8, .high = 0.5}}},
       .default_text = "1e-3",
       .doc = "Relative error of each of -outputs that -fidelity auto keeps below, by its estimates.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.goal.accuracy = v[0]; }},
      {.name = "auto_up_to",
       .kind = Kind::choice,
       .choices = {"slice", "sliding", "axisym"},
       .default_text = "axisym",
       .doc = "Finest model that -fidelity auto may take, and the one that its errors refer to.",
       .set = [](Scene& s, std::size_t, Values v) { s.goal.up_to = model::Fidelity(1 + int(v[0])); }},
      {.name = "axisym_electrostatics",
       .kind = Kind::choice,
       .choices = {"radial", "field", "off"},
       .default_text = "field",
       .doc = "Electric field in the finite elements: closed form across the deformed wall, potential on "
              "the mesh, or none.",
       .set =
           [](Scene& s, std::size_t, Values v) {
             s.axisym.electrostatics = static_cast<model::Electrostatics>(static_cast<int>(v[0]));
           }},
      {.name = "axisym_multipliers",
       .kind = Kind::choice,
       .choices = {"tube", "leg"},
       .default_text = "tube",
       .doc = "Surface whose vertices carry the contact pressure of the finite elements.",
       .set =
           [](Scene& s, std::size_t, Values v) {
             s.axisym.multipliers = static_cast<model::ContactSide>(static_cast<int>(v[0]));
           }},
      {.name = "axisym_order",
       .kind = Kind::count,
       .components = {{.range = {.low = 2, .high = 4}}},
       .default_text = "2",
       .doc = "Polynomial order of the finite elements' displacement.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.axisym.order = static_cast<int>(v[0]); }},
      {.name = "axisym_ranks_per_case",
       .kind = Kind::count,
       .components = {{.range = {.low = 1, .high = 1e6}}},
       .default_text = "1",
       .doc = "MPI ranks that share one finite element mesh.",
       .set = [](Scene& s, std::size_t, Values v) { s.axisym.ranks_per_case = static_cast<int>(v[0]); }},
      {.name = "axisym_refine",
       .kind = Kind::count,
       .components = {{.range = {.low = 0, .high = 8}}},
       .default_text = "1",
       .doc = "Uniform refinements of the coarsest finite element mesh (some 600 unknowns a segment).",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.axisym.refine = static_cast<int>(v[0]); }},
      {.name = "axisym_scope",
       .kind = Kind::choice,
       .choices = {"segment", "leg"},
       .default_text = "segment",
       .doc = "Finite elements of each segment by itself, or of the whole leg as one body.",
       .set = [](Scene& s, std::size_t,
                 Values v) { s.axisym.scope = static_cast<model::AxisymScope>(static_cast<int>(v[0])); }},
      {.name = "axisym_view",
       .kind = Kind::text,
       .scope = Scope::program,
       .format = "a file name that ends in .hdf or .vtkhdf",
       .example = "view.hdf",
       .doc = "Fields of the finite elements for ParaView (VTKHDF), in view_rest.hdf and view_actuated.hdf; "
              "with several segments in view_<s>_rest.hdf and view_<s>_actuated.hdf.",
       .commands = {Command::solve}},
      {.name = "bandage_<s>_length",
       .scope = Scope::one_segment,
       .components = {{.unit = "m", .range = {.low = 1e-6, .high = 1000}}},
       .example = "11.3 cm",
       .doc = "Flat length L of the module, bent into a tube; in place of the stretch.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t i, Values v) { s.bandage.modules[i].length = v[0]; }},
      {.name = "bandage_<s>_stretch",
       .scope = Scope::one_segment,
       .components = {{.range = stretches}},
       .example = "2.2",
       .doc = "Stretch of the module on one segment; wins over bandage_stretch.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t i, Values v) { s.bandage.modules[i].stretch = v[0]; }},
      {.name = "bandage_<s>_voltage",
       .scope = Scope::one_segment,
       .components = {{.unit = "V", .range = voltages}},
       .example = "11.3 kV",
       .doc = "Voltage of the module on one segment; wins over voltage.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t i, Values v) { s.bandage.modules[i].voltage = v[0]; }},
      {.name = "bandage_breakdown_field",
       .components = {{.unit = "V m-1", .range = positive_or_infinite}},
       .default_text = "inf",
       .doc = "True electric field at which the elastomer breaks down.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.bandage.breakdown_field = v[0]; }},
      {.name = "bandage_bulk_modulus",
       .components = {{.unit = "Pa", .range = positive_or_infinite}},
       .default_text = "inf",
       .doc = "Bulk modulus of the elastomer (fidelity axisym; all else is incompressible).",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.bandage.bulk_modulus = v[0]; }},
      {.name = "bandage_layers",
       .kind = Kind::count,
       .components = {{.range = {.low = 1, .high = 1000}}},
       .default_text = "1",
       .doc = "Layers of equal reference thickness, electrically in parallel.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.bandage.layers = static_cast<int>(v[0]); }},
      {.name = "bandage_length_at",
       .kind = Kind::choice,
       .choices = {"outer", "middle", "inner"},
       .default_text = "outer",
       .doc = "Radius of the wall that the flat length and the stretch refer to.",
       .set = [](Scene& s, std::size_t,
                 Values v) { s.bandage.length_at = static_cast<model::LengthAt>(static_cast<int>(v[0])); }},
      {.name = "bandage_ogden_alpha",
       .count = {1, 8},
       .components = {{.range = {.low = 0, .high = 50, .low_open = true, .magnitude = true}}},
       .example = "3.507, 12.147",
       .doc = "Ogden exponents, one a term of W = sum mu/alpha (l1^alpha + l2^alpha + l3^alpha - 3).",
       .sweepable = true,
       .set =
           [](Scene& s, std::size_t, Values v) {
             s.bandage.ogden.resize(v.size());
             for (std::size_t i = 0; i < v.size(); ++i) s.bandage.ogden[i].alpha = v[i];
           }},
      {.name = "bandage_ogden_mu",
       .count = {1, 8},
       .components = {{.unit = "Pa", .range = {.low = 1e-2, .high = 1e12, .magnitude = true}}},
       .example = "21.193 kPa, 10.514 Pa",
       .doc = "Ogden moduli, one a term; the initial shear modulus, half the sum of mu alpha, is positive.",
       .sweepable = true,
       .set =
           [](Scene& s, std::size_t, Values v) {
             s.bandage.ogden.resize(v.size());
             for (std::size_t i = 0; i < v.size(); ++i) s.bandage.ogden[i].mu = v[i];
           }},
      {.name = "bandage_permittivity",
       .components = {{.range = {.low = 1, .high = 1e6}}},
       .default_text = "1",
       .doc = "Relative permittivity of the elastomer.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.bandage.permittivity = v[0]; }},
      {.name = "bandage_stretch",
       .scope = Scope::every_segment,
       .components = {{.range = stretches}},
       .example = "2.2",
       .doc = "Undeformed mean leg radius over the bandage's reference radius, of all modules.",
       .sweepable = true,
       .yields_to = {"bandage_<s>_length", "bandage_<s>_stretch"},
       .set = [](Scene& s, std::size_t i, Values v) { s.bandage.modules[i].stretch = v[0]; }},
      {.name = "bandage_thickness",
       .components = {{.unit = "m", .range = {.low = 1e-10, .high = 1}}},
       .default_text = "1 mm",
       .doc = "Undeformed wall; leaves a hole in the reference tube.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.bandage.thickness = v[0]; }},
      {.name = "contact_axial",
       .kind = Kind::choice,
       .choices = {"free", "held"},
       .default_text = "free",
       .doc = "Whether the bandage slides along the leg without friction, or stays where it was laid on "
              "(fidelity sliding and axisym).",
       .set = [](Scene& s, std::size_t,
                 Values v) { s.contact_axial = static_cast<model::ContactAxial>(static_cast<int>(v[0])); }},
      {.name = "fidelity",
       .kind = Kind::choice,
       .choices = {"rigid", "slice", "sliding", "axisym", "first_order", "auto"},
       .default_text = "slice",
       .doc =
           "How much is modelled: a leg that does not give way, or does so to first order; slices that each "
           "find their equilibrium, "
           "slices "
           "coupled by a tube that slides along the leg, or both bodies by finite elements in contact; auto "
           "takes for each segment the cheapest of them that reaches -accuracy.",
       .set = [](Scene& s, std::size_t,
                 Values v) { s.fidelity = static_cast<model::Fidelity>(static_cast<int>(v[0])); }},
      {.name = "leg_<s>_compliance",
       .scope = Scope::one_segment,
       .count = {4, 4},
       .components = {{"a", "1", {.low = 0, .high = 1, .low_open = true, .high_open = true}},
                      {"b", "Pa-1", positive},
                      {"c", "1", {.high = 0, .low_open = true}},
                      {"d", "Pa-1", {.high = 0, .low_open = true, .high_open = true}}},
       .example = "0.013392, 7.898e-5, -0.016, -0.001137",
       .doc = "Constants a,b,c,d of the radial strain a exp(b P) + c exp(d P); a + c is above -1.",
       .sweepable = true,
       .set =
           [](Scene& s, std::size_t i, Values v) {
             s.leg.segments[i].given.compliance = {v[0], v[1], v[2], v[3]};
             s.leg.scale();
           }},
      {.name = "leg_<s>_height",
       .scope = Scope::one_segment,
       .components = {{.unit = "m", .range = {.low = 1e-4, .high = 10}}},
       .example = "35 mm",
       .doc = "Height of the segment along the leg.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t i, Values v) { s.leg.segments[i].height = v[0]; }},
      {.name = "leg_<s>_radius",
       .scope = Scope::one_segment,
       .count = {2, 2},
       .components = {{"lower", "m", radii}, {"upper", "m", radii}},
       .example = "35.85 mm, 43.37 mm",
       .doc = "Undeformed radii of the segment, at the end nearer the ankle and at the end nearer the knee.",
       .sweepable = true,
       .set =
           [](Scene& s, std::size_t i, Values v) {
             s.leg.segments[i].given.lower_radius = v[0];
             s.leg.segments[i].given.upper_radius = v[1];
             s.leg.scale();
           }},
      {.name = "leg_compliance_data_limit",
       .components = {{.unit = "Pa", .range = positive_or_infinite}},
       .default_text = "7 kPa",
       .doc = "Pressure up to which the compliance was measured; results beyond are marked extrapolated.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.leg.data_limit = v[0]; }},
      {.name = "leg_compliance_scale",
       .components = {{.range = scales}},
       .default_text = "1",
       .doc =
           "Factor on the strains of leg_<s>_compliance (its a and c): a leg that gives way more, or less.",
       .sweepable = true,
       .set =
           [](Scene& s, std::size_t, Values v) {
             s.leg.compliance_scale = v[0];
             s.leg.scale();
           }},
      {.name = "leg_compliance_variant",
       .kind = Kind::choice,
       .choices = {"published", "anchored"},
       .default_text = "published",
       .doc = "Strain law as published, or anchored: c = -a, so that no pressure means no strain.",
       .set =
           [](Scene& s, std::size_t, Values v) {
             s.leg.variant = static_cast<model::ComplianceVariant>(static_cast<int>(v[0]));
           }},
      {.name = "leg_material",
       .kind = Kind::choice,
       .choices = {"compliance", "neo_hookean"},
       .default_text = "compliance",
       .doc = "Law of the compliant leg: the segments' compliance, or leg_young and leg_poisson.",
       .set = [](Scene& s, std::size_t,
                 Values v) { s.leg.material = static_cast<model::LegMaterial>(static_cast<int>(v[0])); }},
      {.name = "leg_model",
       .kind = Kind::choice,
       .choices = {"compliant", "rigid"},
       .default_text = "compliant",
       .doc = "Whether the leg gives way.",
       .set = [](Scene& s, std::size_t,
                 Values v) { s.leg.model = static_cast<model::LegModel>(static_cast<int>(v[0])); }},
      {.name = "leg_poisson",
       .components = {{.range = {.low = 0, .high = 0.5, .high_open = true}}},
       .default_text = "0.4",
       .doc = "Poisson's ratio of the neo-Hookean leg.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.leg.poisson_ratio = v[0]; }},
      {.name = "leg_radius_scale",
       .components = {{.range = scales}},
       .default_text = "1",
       .doc = "Factor on leg_<s>_radius of all segments: a thicker or a thinner leg of the same shape.",
       .sweepable = true,
       .set =
           [](Scene& s, std::size_t, Values v) {
             s.leg.radius_scale = v[0];
             s.leg.scale();
           }},
      {.name = "leg_shear_modulus",
       .components = {{.unit = "Pa", .range = {.low = 0, .high = 1e12, .low_open = true}}},
       .default_text = "10 kPa",
       .doc = "Shear modulus of the leg with the compliance material (fidelity axisym).",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.leg.shear_modulus = v[0]; }},
      {.name = "leg_young",
       .components = {{.unit = "Pa", .range = {.low = 1, .high = 1e13}}},
       .default_text = "80 kPa",
       .doc = "Young's modulus of the neo-Hookean leg.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.leg.young_modulus = v[0]; }},
      {.name = "sliding_count",
       .kind = Kind::count,
       .components = {{.range = {.low = 3, .high = 100000}}},
       .default_text = "24",
       .doc = "Slices a segment at fidelity sliding, rounded up to a multiple of three.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t,
                 Values v) { s.discretisation.sliding_count = static_cast<int>(v[0]); }},
      {.name = "voltage",
       .scope = Scope::every_segment,
       .components = {{.unit = "V", .range = voltages}},
       .default_text = "0 V",
       .doc = "Voltage of all modules once actuated.",
       .sweepable = true,
       .yields_to = {"bandage_<s>_voltage"},
       .set = [](Scene& s, std::size_t i, Values v) { s.bandage.modules[i].voltage = v[0]; }},
  };
}

}  // namespace

bool Range::contains(double value) const {
  if (magnitude) value = std::abs(value);
  const bool above = low_open ? value > low : value >= low;
  const bool below = high_open ? value < high : value <= high;
  return above && below;
}

std::span<const Option> option_table() {
  static const std::vector<Option> table = [] {
    std::vector<Option> all = make_table();
    std::ranges::move(program_options(), std::back_inserter(all));
    std::ranges::move(slice_options(), std::back_inserter(all));
    std::ranges::sort(all, {}, &Option::name);
    return all;
  }();
  return table;
}

const Option& option(std::string_view name) {
  const auto table = option_table();
  const auto found = std::ranges::lower_bound(table, name, {}, &Option::name);
  if (found == table.end() || found->name != name) {
    throw std::logic_error("no option " + std::string(name) + " in the table");
  }
  return *found;
}

std::string name_for(const Option& option, std::string_view segment) {
  std::string name(option.name);
  if (const auto at = name.find("<s>"); at != std::string::npos) name.replace(at, 3, segment);
  return name;
}

std::string component_name(const Option& option, std::size_t component) {
  const std::string_view label = option.component(component).label;
  return label.empty() || option.components.size() == 1 ? std::to_string(component + 1) : std::string(label);
}

}  // namespace gaiter::studies
