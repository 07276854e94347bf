// math: functions with the same bits on every machine, and random numbers of the program's own.
#include <cmath>
#include <limits>
#include <numbers>

#include <lua5.4/lauxlib.h>
#include <lua5.4/lua.h>

#include "core/numbers/math.hpp"
#include "script/libraries.hpp"
#include "script/state.hpp"

namespace rubicon::script {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

double log_of(double x) {
  if (std::isnan(x) || x < 0)
    return no_number;
  if (x == 0)
    return -infinite;
  return std::isinf(x) ? x : math::log(x);
}

double exp_of(double x) {
  return std::isnan(x) ? x : math::exp(x);
}

double sine(double turns) {
  constexpr double turns_max = 2147483648.0;
  return std::abs(turns) < turns_max ? math::sine_of_turns(turns) : no_number;
}

/// By squaring, so that small whole powers are exact.
double whole_power(double x, unsigned n) {
  double out = 1;
  for (; n > 0; n /= 2, x *= x)
    out *= n % 2 == 1 ? x : 1;
  return out;
}

double power(double x, double y) {
  constexpr double whole_max = 1024;
  if (y == std::floor(y) && std::abs(y) <= whole_max) {
    const auto out = whole_power(x, static_cast<unsigned>(std::abs(y)));
    return y < 0 ? 1 / out : out;
  }
  if (x == 0)
    return y > 0 ? 0 : infinite;
  return exp_of(y * log_of(x));
}

int lua_exp(lua_State* lua) {
  lua_pushnumber(lua, exp_of(luaL_checknumber(lua, 1)));
  return 1;
}

int lua_log(lua_State* lua) {
  const double x = luaL_checknumber(lua, 1);
  if (lua_isnoneornil(lua, 2))
    lua_pushnumber(lua, log_of(x));
  else if (const double base = luaL_checknumber(lua, 2); base == 10 && x > 0 && !std::isinf(x))
    lua_pushnumber(lua, math::log10(x));
  else
    lua_pushnumber(lua, log_of(x) / log_of(base));
  return 1;
}

int lua_pow(lua_State* lua) {
  lua_pushnumber(lua, power(luaL_checknumber(lua, 1), luaL_checknumber(lua, 2)));
  return 1;
}

double turns(lua_State* lua) {
  return luaL_checknumber(lua, 1) / (2 * std::numbers::pi);
}

int lua_sin(lua_State* lua) {
  lua_pushnumber(lua, sine(turns(lua)));
  return 1;
}

int lua_cos(lua_State* lua) {
  lua_pushnumber(lua, sine(turns(lua) + 0.25));
  return 1;
}

int lua_tan(lua_State* lua) {
  lua_pushnumber(lua, sine(turns(lua)) / sine(turns(lua) + 0.25));
  return 1;
}

int lua_random(lua_State* lua) {
  auto& rng = state::of(lua).rng();
  if (lua_gettop(lua) == 0) {
    lua_pushnumber(lua, rng.unit());
    return 1;
  }
  const bool has_both = lua_gettop(lua) > 1;
  const auto low = has_both ? luaL_checkinteger(lua, 1) : 1;
  const auto high = luaL_checkinteger(lua, has_both ? 2 : 1);
  luaL_argcheck(lua, low <= high, has_both ? 2 : 1, "interval is empty");
  const auto width = static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low);
  const auto drawn =
      width == std::numeric_limits<std::uint64_t>::max() ? rng.next() : rng.below(width + 1);
  lua_pushinteger(lua, static_cast<lua_Integer>(static_cast<std::uint64_t>(low) + drawn));
  return 1;
}

int lua_normal(lua_State* lua) {
  lua_pushnumber(lua, state::of(lua).rng().normal());
  return 1;
}

} // namespace

void change_math(lua_State* lua) {
  constexpr luaL_Reg functions[] = {
      {"exp", lua_exp},  {"log", lua_log},       {"pow", lua_pow},        {"sin", lua_sin},
      {"cos", lua_cos},  {"tan", lua_tan},       {"asin", nullptr},       {"acos", nullptr},
      {"atan", nullptr}, {"random", lua_random}, {"randomseed", nullptr}, {"normal", lua_normal},
  };
  for (const auto& x : functions) {
    if (x.func != nullptr)
      lua_pushcfunction(lua, x.func);
    else
      lua_pushnil(lua);
    lua_setfield(lua, -2, x.name);
  }
}

} // namespace rubicon::script
