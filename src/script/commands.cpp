#include "script/commands.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <lua5.4/lauxlib.h>
#include <lua5.4/lua.h>

#include "core/address.hpp"
#include "core/text/printable.hpp"
#include "device/transducer.hpp"
#include "script/libraries.hpp"
#include "script/program.hpp"
#include "script/state.hpp"

namespace rubicon::script {

namespace {

// -- arguments

program& owner_of(lua_State* lua) {
  return *static_cast<program*>(lua_touserdata(lua, lua_upvalueindex(1)));
}

communication::interface& layer_of(lua_State* lua) {
  return owner_of(lua).layer();
}

/// A whole number from 0 that T can hold; an error of the script if it is another.
template <class T>
T whole(lua_State* lua, int index) {
  const auto x = luaL_checkinteger(lua, index);
  constexpr auto most = static_cast<lua_Integer>(std::numeric_limits<T>::max());
  if (x < 0 || x > most)
    luaL_argerror(lua, index,
                  lua_pushfstring(lua, "a whole number from 0 to %I is needed",
                                  static_cast<LUAI_UACINT>(most)));
  return static_cast<T>(x);
}

template <class T>
T whole_or(lua_State* lua, int index, T otherwise) {
  return lua_isnoneornil(lua, index) ? otherwise : whole<T>(lua, index);
}

int descriptor(lua_State* lua) {
  return whole<int>(lua, 1);
}

std::string_view text(lua_State* lua, int index) {
  std::size_t size = 0;
  const char* found = luaL_checklstring(lua, index, &size);
  return {found, size};
}

byte_view octets(lua_State* lua, int index) {
  const auto x = text(lua, index);
  return {reinterpret_cast<const std::uint8_t*>(x.data()), x.size()};
}

mote_address address(lua_State* lua) {
  return {island_id(whole<std::uint32_t>(lua, 1)), mote_id(whole<std::uint16_t>(lua, 2))};
}

device::quantity quantity_at(lua_State* lua, int index) {
  if (lua_type(lua, index) == LUA_TNUMBER) {
    const auto number = luaL_checkinteger(lua, index);
    if (number >= 0 && number < static_cast<lua_Integer>(device::quantities_max))
      return static_cast<device::quantity>(number);
  } else if (lua_type(lua, index) == LUA_TSTRING) {
    const auto word = text(lua, index);
    for (std::size_t i = 0; i < device::first_own_quantity; ++i)
      if (device::to_string(static_cast<device::quantity>(i)) == word)
        return static_cast<device::quantity>(i);
  }
  luaL_error(lua, "no quantity: a name as \"temperature\", or a number below 32, is needed");
  return {};
}

duration time_at(lua_State* lua, int index) {
  constexpr double seconds_max = 10 * 365.0 * 86400;
  const double x = luaL_checknumber(lua, index);
  const bool is_good = x >= seconds(timer_min) && x <= seconds_max;
  luaL_argcheck(lua, is_good, index, "seconds from 0.001 to ten years are needed");
  return duration(static_cast<duration::rep>(x * 1e9 + 0.5));
}

// -- results

/// What an event of the command has raised inside of it ends the script.
int returned(lua_State* lua, int values) {
  state::of(lua).check_goes_on();
  return values;
}

int give(lua_State* lua, communication::status x) {
  lua_pushboolean(lua, x == communication::SUCCESS ? 1 : 0);
  return returned(lua, 1);
}

int give_positive(lua_State* lua, int x) {
  if (x > 0)
    lua_pushinteger(lua, x);
  else
    lua_pushnil(lua);
  return returned(lua, 1);
}

int give_seconds(lua_State* lua, std::optional<duration> x) {
  if (x)
    lua_pushnumber(lua, seconds(*x));
  else
    lua_pushnil(lua);
  return 1;
}

// -- D1.1 5.3.1

template <bool is_out>
int create_syn_channel(lua_State* lua) {
  const auto other = address(lua);
  const auto size = whole<std::uint8_t>(lua, 3);
  synaptic::parameters x;
  x.island = other.island;
  x.divisor = whole_or<std::uint8_t>(lua, 4, 1);
  x.qos = whole_or<std::uint8_t>(lua, 5, 0);
  auto& layer = layer_of(lua);
  return give_positive(lua, is_out ? layer.create_syn_channel_out(other, size, x)
                                   : layer.create_syn_channel_in(other, size, x));
}
int dispose_syn_channel(lua_State* lua) {
  return give(lua, layer_of(lua).dispose_syn_channel(descriptor(lua)));
}
int start_syn_channel(lua_State* lua) {
  return give(lua, layer_of(lua).start_syn_channel(descriptor(lua)));
}
int stop_syn_channel(lua_State* lua) {
  return give(lua, layer_of(lua).stop_syn_channel(descriptor(lua)));
}
int write_output(lua_State* lua) {
  const auto k = whole<std::uint8_t>(lua, 2);
  const auto value = static_cast<float>(luaL_checknumber(lua, 3));
  return give(lua, layer_of(lua).write_output(descriptor(lua), k, value));
}
int read_input(lua_State* lua) {
  const auto x = layer_of(lua).read_input(descriptor(lua), whole<std::uint8_t>(lua, 2));
  if (std::isnan(x))
    lua_pushnil(lua);
  else
    lua_pushnumber(lua, static_cast<double>(x));
  return 1;
}

// -- 5.3.2

template <bool writes>
int open_end(lua_State* lua) {
  communication::stream_end end;
  end.other = address(lua);
  end.name = whole<std::uint16_t>(lua, 3);
  end.rate_ms = whole_or<std::uint32_t>(lua, 4, 0);
  end.qos = whole_or<std::uint8_t>(lua, 5, 0);
  end.writes_to_self = writes;
  return give_positive(lua, layer_of(lua).open_end(end));
}
int open_sensor(lua_State* lua) {
  const auto kind = static_cast<std::uint8_t>(quantity_at(lua, 1));
  const auto rate = whole_or<std::uint32_t>(lua, 2, 0);
  return give_positive(lua, layer_of(lua).open_sensor(kind, rate,
                                                      rate > 0 ? stream::sampling::periodic
                                                               : stream::sampling::on_demand));
}
int open_local(lua_State* lua) {
  return give_positive(lua, layer_of(lua).open_local());
}
int close(lua_State* lua) {
  return give(lua, layer_of(lua).close(descriptor(lua)));
}
int read(lua_State* lua) {
  return give(lua, layer_of(lua).read(descriptor(lua), whole<std::uint16_t>(lua, 2)));
}
int write(lua_State* lua) {
  const auto written = layer_of(lua).write(descriptor(lua), octets(lua, 2));
  lua_pushboolean(lua, written >= 0 ? 1 : 0);
  return returned(lua, 1);
}
int has_ended(lua_State* lua) {
  lua_pushboolean(lua, layer_of(lua).has_ended(descriptor(lua)) ? 1 : 0);
  return 1;
}
int latency_bound(lua_State* lua) {
  return give_seconds(lua, layer_of(lua).latency_bound(descriptor(lua)));
}

// -- 5.3.3

int send(lua_State* lua) {
  const auto to = address(lua);
  const auto message = octets(lua, 3);
  const auto am_type = whole<std::uint8_t>(lua, 4);
  const auto number = layer_of(lua).send_numbered(to, message, lua_toboolean(lua, 5) != 0, am_type);
  if (number)
    lua_pushinteger(lua, *number);
  else
    lua_pushnil(lua);
  return returned(lua, 1);
}
int provide(lua_State* lua) {
  return give(lua, layer_of(lua).provide(whole<std::uint8_t>(lua, 1)));
}
int hold(lua_State* lua) {
  layer_of(lua).hold(whole<std::uint8_t>(lua, 1));
  return returned(lua, 0);
}
int release(lua_State* lua) {
  layer_of(lua).release(whole<std::uint8_t>(lua, 1));
  return returned(lua, 0);
}

// -- what a mote carries

int read_transducers(lua_State* lua) {
  luaL_checktype(lua, 1, LUA_TTABLE);
  std::vector<device::quantity> kinds;
  for (lua_Integer i = 1; i <= static_cast<lua_Integer>(device::quantities_max); ++i) {
    if (lua_rawgeti(lua, 1, i) == LUA_TNIL)
      break;
    kinds.push_back(quantity_at(lua, -1));
    lua_pop(lua, 1);
  }
  luaL_argcheck(lua, !kinds.empty(), 1, "no quantities");
  return give(lua, layer_of(lua).read_transducers(kinds));
}
int set_actuator(lua_State* lua) {
  return give(lua, layer_of(lua).set_actuator(text(lua, 1), whole<std::uint8_t>(lua, 2)));
}

// -- address and time

int own_address(lua_State* lua) {
  const auto x = layer_of(lua).address();
  if (!x)
    return 0;
  lua_pushinteger(lua, x->island.value);
  lua_pushinteger(lua, x->mote.value);
  return 2;
}
int now(lua_State* lua) {
  return give_seconds(lua, owner_of(lua).now().time_since_epoch());
}
int network_time(lua_State* lua) {
  return give_seconds(lua, layer_of(lua).network_time());
}

// -- timers

template <bool repeats>
int start_timer(lua_State* lua) {
  const auto after = time_at(lua, 1);
  luaL_checktype(lua, 2, LUA_TFUNCTION);
  lua_settop(lua, 2);
  const int function = luaL_ref(lua, LUA_REGISTRYINDEX);
  const auto number = owner_of(lua).own().add_timer(owner_of(lua).now(), after, repeats, function);
  if (!number) {
    luaL_unref(lua, LUA_REGISTRYINDEX, function);
    return luaL_error(lua, "more than %d timers", static_cast<int>(timers_max));
  }
  lua_pushinteger(lua, *number);
  return 1;
}
int cancel(lua_State* lua) {
  const auto function = owner_of(lua).own().remove_timer(whole<std::uint32_t>(lua, 1));
  if (function)
    luaL_unref(lua, LUA_REGISTRYINDEX, *function);
  lua_pushboolean(lua, function ? 1 : 0);
  return 1;
}

// -- reports

template <bool is_warning>
int notice(lua_State* lua) {
  std::string line;
  for (int i = 1; i <= lua_gettop(lua) && line.size() <= text_max; ++i) {
    push_text(lua, i);
    line += i > 1 ? " " : "";
    line += text(lua, -1).substr(0, text_max + 1);
    lua_pop(lua, 1);
  }
  auto& owner = owner_of(lua);
  if (const char* wrong = owner.own().add_notice())
    return luaL_error(lua, "%s", wrong);
  line = printable(line, text_max);
  if (is_warning)
    owner.warn("event=script text=\"" + line + '"');
  else
    owner.notify(std::move(line));
  return 0;
}
int figure(lua_State* lua) {
  const double value = luaL_checknumber(lua, 2);
  luaL_argcheck(lua, std::isfinite(value), 2, "a finite number is needed");
  if (const char* wrong = owner_of(lua).own().set_figure(text(lua, 1), value))
    return luaL_error(lua, "%s", wrong);
  return 0;
}

constexpr luaL_Reg layer_functions[] = {
    {"create_syn_channel_out", create_syn_channel<true>},
    {"create_syn_channel_in", create_syn_channel<false>},
    {"dispose_syn_channel", dispose_syn_channel},
    {"start_syn_channel", start_syn_channel},
    {"stop_syn_channel", stop_syn_channel},
    {"write_output", write_output},
    {"read_input", read_input},
    {"open_remote", open_end<false>},
    {"open_write_end", open_end<true>},
    {"open_sensor", open_sensor},
    {"open_local", open_local},
    {"close", close},
    {"read", read},
    {"write", write},
    {"has_ended", has_ended},
    {"latency_bound", latency_bound},
    {"send", send},
    {"provide", provide},
    {"hold", hold},
    {"release", release},
    {"read_transducers", read_transducers},
    {"set_actuator", set_actuator},
    {"address", own_address},
    {"now", now},
    {"network_time", network_time},
    {nullptr, nullptr},
};

constexpr luaL_Reg global_functions[] = {
    {"after", start_timer<false>},
    {"every", start_timer<true>},
    {"cancel", cancel},
    {"notify", notice<false>},
    {"print", notice<false>},
    {"warn", notice<true>},
    {"figure", figure},
    {nullptr, nullptr},
};

void set_whole(lua_State* lua, const char* name, lua_Integer x) {
  lua_pushinteger(lua, x);
  lua_setglobal(lua, name);
}

} // namespace

void add_commands(lua_State* lua, program& owner) {
  lua_newtable(lua);
  lua_pushlightuserdata(lua, &owner);
  luaL_setfuncs(lua, layer_functions, 1);
  lua_setglobal(lua, "layer");
  lua_pushglobaltable(lua);
  lua_pushlightuserdata(lua, &owner);
  luaL_setfuncs(lua, global_functions, 1);
  lua_pop(lua, 1);
  set_whole(lua, "OWN_ISLAND", own_island.value);
  set_whole(lua, "GATEWAY", no_mote.value);
}

} // namespace rubicon::script
