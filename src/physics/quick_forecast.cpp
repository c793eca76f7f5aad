// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/quick_forecast.hpp"

#include "gaiter/physics/forecast_errors.hpp"
#include "gaiter/physics/quick_states.hpp"

namespace gaiter::physics {

namespace {

using namespace forecast;

constexpr float caution_of_two = 1.005f;  // of two heights together
constexpr float least_at_end = 0.02f;     // of the passive pressure, left by the voltage at the narrow end
constexpr float beyond_all = 1e30f;
template <typename Number>
constexpr Number rounding = 16 * std::numeric_limits<Number>::epsilon();

// Of a pressure, relative. The leg's strain is a difference, and a bandage that is hardly stretched feels its
// last digits.
template <typename Number>
GAITER_INLINE Number noise(const ForecastInput<Number>& input, const State<Number>& s, int i) {
  const bool law = input.material == model::LegMaterial::compliance;
  const Number parts = law ? std::fabs(input.leg[0][i]) + std::fabs(input.leg[2][i]) : Number(1);
  return rounding<Number> * (1 + parts * std::fabs(s.slope[i]) / (s.pressure[i] * (1 + s.gain[i])));
}

// What a state that counts says of the errors, if that is worse than what another did.
template <typename Number>
GAITER_INLINE void tell(const ForecastInput<Number>& input, const State<Number>& s,
                        const PackOf<Number>& counts, QuickForecast<Number>& found, PackOf<Number>& share,
                        LegPoles<Number>& poles) {
  LegPoles<Number> own;
  PackOf<Number> x, up, fall, log_fall;
  find_poles(input, s.pressure, s.slope, s.response, own);
  GAITER_EACH {
    // An error that goes with a power of the pressure is larger at the wide end than it is small at the
    // narrow one.
    const Number raised = std::fabs(input.taper[i] * s.slope[i] / s.pressure[i]);
    const Number limited = raised < 7 ? raised : Number(7);
    x[i] = larger(limited, Number(1e-3f));
    fall[i] = s.rigid[i] / s.pressure[i];
    log_fall[i] = larger(fall[i], least<Number>);
  }
  exp_each(x, up);
  log_each(log_fall, log_fall);
  GAITER_EACH {
    const Number down = 1 / up[i], over = 1 / x[i];
    const Number spread = 0.5f * (up[i] - down) * over;
    const Number spread_of_cube = (up[i] * up[i] * up[i] - down * down * down) * over * Number(1.0 / 6);
    const Number own_share = counts[i] / (s.pressure[i] * (1 + s.gain[i]));
    // The error may be small by chance in the middle, and is not at the ends.
    const Number at_ends = input.taper[i] * s.response[i] * s.slope[i] * s.slope[i] * own_share;
    const Number typical = Number(0.3) * log_fall[i] * log_fall[i] + Number(0.1) * at_ends * at_ends;
    const Number missed = caution * std::fabs(s.first[i] / s.pressure[i] - 1);
    const Number yields = counts[i] * input.gives_way[i], size = std::fabs(s.strain[i]);
    const Number of_middle = caution_of_mean(x[i]) * std::fabs(fall[i] - 1);
    const Number rounded = noise(input, s, i);
    const Number rigid_error = yields * (spread * of_middle + rounded);
    const Number first_error = yields * (spread_of_cube * larger(missed, typical) + rounded);
    const Number at_middle = yields * (missed / caution + rounded);
    const Number volume = counts[i] * s.pressure[i] * s.response[i] / (size > 0 ? size : Number(beyond_all));
    found.compliance[i] = larger(found.compliance[i], rigid_error);
    found.first_order[i] = larger(found.first_order[i], first_error);
    found.first_order_at_middle[i] = larger(found.first_order_at_middle[i], at_middle);
    found.volume_factor[i] = larger(found.volume_factor[i], volume);
    share[i] = larger(share[i], own_share);
  }
  for (int k = 0; k < 2; ++k) GAITER_EACH {
      poles.part[k][i] = larger(poles.part[k][i], counts[i] * own.part[k][i]);
      poles.fall[k][i] = larger(poles.fall[k][i], counts[i] * own.fall[k][i]);
    }
}

// Of both heights together, if that is worse than what another state had: with e the error there and P the
// pressure, sum e P over sum P, which is exact to the third order in the height.
template <typename Number>
GAITER_INLINE void compare(const ForecastInput<Number>& input, const State<Number>& low,
                           const State<Number>& high, const PackOf<Number>& wrong_low,
                           const PackOf<Number>& wrong_high, int doubts, const PackOf<Number>& counts,
                           PackOf<Number>& error) {
  GAITER_EACH {
    const Number inverse = 1 / (low.pressure[i] + high.pressure[i]);
    const Number below = wrong_low[i] - low.pressure[i], above = wrong_high[i] - high.pressure[i];
    const Number mean = std::fabs(below + above) * inverse, apart = std::fabs(below - above) * inverse;
    // The next order, larger where the two are small together by chance.
    const Number beyond = Number(0.03) * apart * apart / (mean + apart + least<Number>);
    const Number doubt = larger(low.doubt[i], high.doubt[i]);
    const Number rounded = larger(noise(input, low, i), noise(input, high, i));
    const Number found = caution_of_two * mean + beyond + doubts * doubt + rounded;
    error[i] = larger(error[i], counts[i] * found);
  }
}

}  // namespace

template <typename Number>
GAITER_INLINE void QuickForecast<Number>::work_out(const Input& input, const Pack& rest_counts,
                                                   const Pack& actuated_counts) {
  const bool voltage = input.energised;
  States<Number> states;
  Pressing<Number> end;
  Pack none, wider, strain;
  find_states(input, sure, states);
  const auto& [undeformed, rest, actuated] = states;
  GAITER_EACH none[i] = 0;
  strain_law(input, none, strain, wider);
  GAITER_EACH wider[i] = (1 - std::fabs(input.taper[i])) * (1 - input.gives_way[i] * strain[i]) - 1;
  press(input, voltage, wider, end);
  GAITER_EACH {
    const bool pressing = (end.passive[i] > 0) & (end.net(i) > least_at_end * end.passive[i]);
    sure[i] *= pressing ? 1 : 0;
  }

  strain = rest.strain;
  if (voltage) GAITER_EACH strain[i] = actuated.strain[i] < strain[i] ? actuated.strain[i] : strain[i];
  find_errors(input, strain, errors_);

  poles_ = {};
  share_ = {};
  GAITER_EACH {
    compliance[i] = first_order[i] = first_order_at_middle[i] = 0;
    volume_factor[i] = drop_factor[i] = 1;
  }
  tell(input, rest, rest_counts, *this, share_, poles_);
  if (voltage) {
    tell(input, actuated, actuated_counts, *this, share_, poles_);
    GAITER_EACH {
      const Number drop = rest.pressure[i] - actuated.pressure[i];
      const Number safe = drop > 0 ? drop : rest.pressure[i];
      drop_factor[i] = rest.pressure[i] / safe;
    }
  }
  const State<Number>& loaded = voltage ? actuated : rest;
  loaded_pressure_ = loaded.pressure;
  loaded_strain_ = loaded.strain;
  loaded_response_ = loaded.response;
  GAITER_EACH {
    taper_[i] = std::fabs(input.taper[i]);
    loaded_give_[i] = loaded.slope[i] / (1 + loaded.gain[i]);
    const Number sum = compliance[i] + first_order[i] + volume_factor[i] + share_[i] + errors_.height[1][i] +
                       errors_.height[2][i] + errors_.wall[0][i] + errors_.wall[1][i] + errors_.wall[2][i] +
                       poles_.part[0][i] + poles_.part[1][i];
    sure[i] *= sum < beyond_all ? 1 : 0;
  }
}

template <typename Number>
GAITER_INLINE void QuickForecast<Number>::work_out_again(Input& input, const Pack& rest_counts,
                                                         const Pack& actuated_counts) {
  const Pack gap = input.gap, leg_radius = input.leg_radius;
  std::array<States<Number>, 2> at;
  std::array<Pack, 2> each;
  for (int k = 0; k < 2; ++k) {
    const Number place = (2 * k - 1) * Number(0.57735026918962576);  // Gauss, 2 points on (-1, 1)
    GAITER_EACH {
      const Number wider = leg_radius[i] * input.taper[i] * place;
      input.gap[i] = gap[i] + wider;
      input.leg_radius[i] = leg_radius[i] + wider;
      input.slack[i] = larger(input.gap[i] / input.leg_radius[i], least<Number>);
    }
    limit_pressure(input);
    find_states(input, each[k], at[k]);
  }
  GAITER_EACH {
    sure[i] *= each[0][i] * each[1][i];
    compliance[i] = first_order[i] = 0;
  }
  const auto take = [&](const State<Number>& low, const State<Number>& high, const Pack& counts) {
    compare(input, low, high, low.rigid, high.rigid, 1, counts, compliance);
    compare(input, low, high, low.first, high.first, 3, counts, first_order);
  };
  take(at[0].rest, at[1].rest, rest_counts);
  if (input.energised) take(at[0].actuated, at[1].actuated, actuated_counts);
  GAITER_EACH sure[i] *= compliance[i] + first_order[i] < beyond_all ? 1 : 0;
}

template <>
GAITER_MULTIVERSION void QuickForecast<double>::analyse(const Input& input, const Pack& rest,
                                                        const Pack& actuated) {
  work_out(input, rest, actuated);
}

template <>
GAITER_MULTIVERSION void QuickForecast<float>::analyse(const Input& input, const Pack& rest,
                                                       const Pack& actuated) {
  work_out(input, rest, actuated);
}

template <>
GAITER_MULTIVERSION void QuickForecast<double>::look_again(Input& input, const Pack& rest,
                                                           const Pack& actuated) {
  work_out_again(input, rest, actuated);
}

template <>
GAITER_MULTIVERSION void QuickForecast<float>::look_again(Input& input, const Pack& rest,
                                                          const Pack& actuated) {
  work_out_again(input, rest, actuated);
}

template class QuickForecast<double>;
template class QuickForecast<float>;

}  // namespace gaiter::physics
