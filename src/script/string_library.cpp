// string: Lua's functions, where their work and their results have bounds that are known before.
#include <string_view>

#include <lua5.4/lauxlib.h>
#include <lua5.4/lua.h>

#include "script/libraries.hpp"
#include "script/state.hpp"

namespace rubicon::script {

namespace {

constexpr double steps_max = 1e7;   ///< of one match
constexpr double steps_each = 1000; ///< that count as one instruction

std::string_view text_at(lua_State* lua, int index) {
  std::size_t size = 0;
  const char* text = luaL_checklstring(lua, index, &size);
  return {text, size};
}

/// Where the item of a pattern ends that begins here, which is a class of characters or one.
std::size_t end_of_item(std::string_view pattern, std::size_t at) {
  if (pattern[at] == '%')
    return at + 2;
  if (pattern[at] != '[')
    return at + 1;
  ++at;
  at += pattern.substr(at).starts_with('^') ? 1 : 0;
  do { // a ] at the beginning is itself
    at += at < pattern.size() && pattern[at] == '%' ? 2 : 1;
  } while (at < pattern.size() && pattern[at] != ']');
  return at + 1;
}

/// A bound of what Lua tries for a pattern: each repetition may have each length.
double steps_of(std::string_view pattern, std::size_t length) {
  const double choices = static_cast<double>(length) + 1;
  double steps = pattern.starts_with('^') ? 1 : choices;
  for (std::size_t i = pattern.starts_with('^') ? 1 : 0; i < pattern.size();) {
    const bool is_special = pattern[i] == '%' && i + 1 < pattern.size();
    const char kind = is_special ? pattern[i + 1] : '\0';
    if (kind == 'b' || (kind >= '0' && kind <= '9'))
      steps *= choices;
    i = end_of_item(pattern, i);
    const char suffix = i < pattern.size() ? pattern[i] : '\0';
    if (suffix == '*' || suffix == '+' || suffix == '-')
      steps *= choices;
    else if (suffix == '?')
      steps *= 2;
  }
  return steps + choices * static_cast<double>(pattern.size()) / 64;
}

/// Upvalues: the function, and whether its fourth argument may say that the pattern is plain.
int match(lua_State* lua) {
  const auto text = text_at(lua, 1);
  const auto pattern = text_at(lua, 2);
  const bool is_plain = lua_toboolean(lua, lua_upvalueindex(2)) != 0 && lua_toboolean(lua, 4) != 0;
  const auto work = static_cast<double>(text.size()) * static_cast<double>(pattern.size()) / 64;
  const auto steps = is_plain ? work : steps_of(pattern, text.size());
  if (steps > steps_max)
    return luaL_error(lua, "the pattern may take too long in a text of %d octets",
                      static_cast<int>(text.size()));
  state::of(lua).charge(static_cast<std::uint64_t>(steps / steps_each));
  lua_pushvalue(lua, lua_upvalueindex(1));
  lua_insert(lua, 1);
  lua_call(lua, lua_gettop(lua) - 1, LUA_MULTRET);
  return lua_gettop(lua);
}

/// Nothing, any number of times, is a loop without bound in Lua's own.
int repeat(lua_State* lua) {
  const auto text = text_at(lua, 1);
  if (text.empty() && (lua_isnoneornil(lua, 3) || text_at(lua, 3).empty())) {
    lua_pushliteral(lua, "");
    return 1;
  }
  lua_pushvalue(lua, lua_upvalueindex(1));
  lua_insert(lua, 1);
  lua_call(lua, lua_gettop(lua) - 1, 1);
  return 1;
}

bool writes_addresses(std::string_view form) {
  for (std::size_t i = 0; i < form.size(); ++i) {
    if (form[i] != '%')
      continue;
    i = form.find_first_not_of("-+ #0123456789.", i + 1);
    if (i == std::string_view::npos)
      return false;
    if (form[i] == 'p')
      return true;
  }
  return false;
}

int format(lua_State* lua) {
  if (writes_addresses(text_at(lua, 1)))
    return luaL_argerror(lua, 1, "addresses are not the same in every run");
  for (int i = 2; i <= lua_gettop(lua); ++i) {
    const int type = lua_type(lua, i);
    if (type == LUA_TNIL || type == LUA_TBOOLEAN || type == LUA_TNUMBER || type == LUA_TSTRING)
      continue;
    push_text(lua, i);
    lua_replace(lua, i);
  }
  lua_pushvalue(lua, lua_upvalueindex(1));
  lua_insert(lua, 1);
  lua_call(lua, lua_gettop(lua) - 1, 1);
  return 1;
}

/// Replaces a function of the library on top of the stack, which becomes the first upvalue.
void wrap(lua_State* lua, const char* name, lua_CFunction by, bool flag = false) {
  lua_getfield(lua, -1, name);
  lua_pushboolean(lua, flag ? 1 : 0);
  lua_pushcclosure(lua, by, 2);
  lua_setfield(lua, -2, name);
}

} // namespace

void change_string(lua_State* lua) {
  wrap(lua, "find", match, true);
  for (const char* name : {"match", "gmatch", "gsub"})
    wrap(lua, name, match);
  wrap(lua, "rep", repeat);
  wrap(lua, "format", format);
  lua_pushnil(lua);
  lua_setfield(lua, -2, "dump");
}

} // namespace rubicon::script
