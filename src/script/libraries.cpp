#include "script/libraries.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string_view>

#include <lua5.4/lauxlib.h>
#include <lua5.4/lua.h>
#include <lua5.4/lualib.h>

#include "script/state.hpp"

namespace rubicon::script {

namespace {

/// Written in Lua, so that their instructions count. Lua's own sort takes its pivots by the clock
/// and its own move has no bound. This one is a merge sort, which keeps the order of equals.
constexpr std::string_view prelude = R"lua(
local function is_less(a, b) return a < b end

local function merge(from, to, a, b, last, less)
  local i, j = a, b
  for k = a, last do
    if i < b and (j > last or not less(from[j], from[i])) then
      to[k], i = from[i], i + 1
    else
      to[k], j = from[j], j + 1
    end
  end
end

function table.sort(list, less)
  less = less or is_less
  local n, from, to, width = #list, list, {}, 1
  while width < n do
    for a = 1, n, 2 * width do
      local b, last = a + width, a + 2 * width - 1
      merge(from, to, a, b <= n and b or n + 1, last < n and last or n, less)
    end
    from, to, width = to, from, 2 * width
  end
  if from ~= list then
    for i = 1, n do list[i] = from[i] end
  end
end

function table.move(from, first, last, at, to)
  to = to or from
  if at > last or at <= first or to ~= from then
    for i = 0, last - first do to[at + i] = from[first + i] end
  else
    for i = last - first, 0, -1 do to[at + i] = from[first + i] end
  end
  return to
end
)lua";

int text_of(lua_State* lua) {
  luaL_checkany(lua, 1);
  push_text(lua, 1);
  return 1;
}

// -- pairs, in the order of keys

/// A key, as an element of an array that Lua owns. Texts stay where they are: the table has them.
struct sortable_key {
  bool is_text = false;
  bool is_whole = false;
  lua_Integer whole = 0;
  double number = 0;
  std::string_view text;
  lua_Integer at = 0; ///< in the list of keys
};

/// Whether a whole number is less than one with a fraction; neither is changed by the other's type.
bool is_below(lua_Integer a, double b) {
  constexpr double beyond = 9223372036854775808.0; // 2^63
  if (b >= beyond)
    return true;
  return b > -beyond && a < static_cast<lua_Integer>(std::ceil(b));
}

bool is_before(const sortable_key& a, const sortable_key& b) {
  if (a.is_text != b.is_text)
    return b.is_text;
  if (a.is_text)
    return a.text < b.text;
  if (a.is_whole && b.is_whole)
    return a.whole < b.whole;
  if (!a.is_whole && !b.is_whole)
    return a.number < b.number;
  return a.is_whole ? is_below(a.whole, b.number) : !is_below(b.whole, a.number);
}

sortable_key key_on_top(lua_State* lua, lua_Integer at) {
  sortable_key x;
  x.at = at;
  if (lua_type(lua, -1) == LUA_TSTRING) {
    std::size_t size = 0;
    const char* text = lua_tolstring(lua, -1, &size);
    x.is_text = true;
    x.text = {text, size};
  } else if (lua_isinteger(lua, -1) != 0) {
    x.is_whole = true;
    x.whole = lua_tointeger(lua, -1);
  } else if (lua_type(lua, -1) == LUA_TNUMBER) {
    x.number = lua_tonumber(lua, -1);
  } else {
    luaL_error(lua, "pairs: keys of type %s have no order", luaL_typename(lua, -1));
  }
  return x;
}

/// The next key that is still there, and its value: upvalues are the list of keys, and where it is.
int next_pair(lua_State* lua) {
  luaL_checktype(lua, 1, LUA_TTABLE);
  auto at = lua_tointeger(lua, lua_upvalueindex(2));
  for (;;) {
    if (lua_rawgeti(lua, lua_upvalueindex(1), ++at) == LUA_TNIL)
      return 1;
    lua_pushvalue(lua, -1);
    if (lua_rawget(lua, 1) != LUA_TNIL)
      break;
    lua_pop(lua, 2);
  }
  lua_pushinteger(lua, at);
  lua_replace(lua, lua_upvalueindex(2));
  return 2;
}

int sorted_pairs(lua_State* lua) {
  luaL_checktype(lua, 1, LUA_TTABLE);
  lua_settop(lua, 1);
  lua_newtable(lua); // 2: keys as they come
  lua_Integer count = 0;
  for (lua_pushnil(lua); lua_next(lua, 1) != 0;) {
    lua_pop(lua, 1);
    lua_pushvalue(lua, -1);
    lua_rawseti(lua, 2, ++count);
  }
  const auto size = static_cast<std::size_t>(count);
  state::of(lua).charge(16 * size);
  auto* memory = lua_newuserdatauv(lua, std::max<std::size_t>(size, 1) * sizeof(sortable_key), 0);
  const std::span keys(static_cast<sortable_key*>(memory), size);
  for (lua_Integer i = 1; i <= count; ++i) {
    lua_rawgeti(lua, 2, i);
    std::construct_at(&keys[static_cast<std::size_t>(i - 1)], key_on_top(lua, i));
    lua_pop(lua, 1);
  }
  std::ranges::sort(keys, is_before);
  lua_createtable(lua, static_cast<int>(count), 0); // 4: keys in order
  for (lua_Integer i = 1; i <= count; ++i) {
    lua_rawgeti(lua, 2, keys[static_cast<std::size_t>(i - 1)].at);
    lua_rawseti(lua, 4, i);
  }
  lua_pushinteger(lua, 0);
  lua_pushcclosure(lua, next_pair, 2);
  lua_pushvalue(lua, 1);
  return 2;
}

/// As Lua's, but what has no room or no instructions left ends.
int protected_call(lua_State* lua) {
  luaL_checkany(lua, 1);
  lua_pushboolean(lua, 1);
  lua_insert(lua, 1);
  const int status = lua_pcall(lua, lua_gettop(lua) - 2, LUA_MULTRET, 0);
  if (status == LUA_OK)
    return lua_gettop(lua);
  if (status != LUA_ERRRUN)
    state::of(lua).fail(status);
  state::of(lua).check_goes_on();
  lua_pushboolean(lua, 0);
  lua_insert(lua, -2);
  return 2;
}

void open(lua_State* lua, const char* name, lua_CFunction library) {
  lua_pushcfunction(lua, library);
  lua_call(lua, 0, 1);
  lua_pushvalue(lua, -1);
  lua_setglobal(lua, name);
}

void change_base(lua_State* lua) {
  // Metatables would let a script see when memory is collected, and give tables lengths without
  // bound.
  for (const char* name :
       {"dofile", "load", "loadfile", "collectgarbage", "getmetatable", "setmetatable", "rawget",
        "rawset", "rawlen", "next", "xpcall", "warn", "print"}) {
    lua_pushnil(lua);
    lua_setglobal(lua, name);
  }
  lua_register(lua, "pairs", sorted_pairs);
  lua_register(lua, "pcall", protected_call);
  lua_register(lua, "tostring", text_of);
}

} // namespace

void push_text(lua_State* lua, int index) {
  switch (lua_type(lua, index)) {
  case LUA_TNUMBER:
    if (lua_isinteger(lua, index) == 0 && std::isnan(lua_tonumber(lua, index))) {
      lua_pushliteral(lua, "nan");
      return;
    }
    [[fallthrough]];
  case LUA_TNIL:
  case LUA_TBOOLEAN:
  case LUA_TSTRING:
    luaL_tolstring(lua, index, nullptr);
    return;
  default:
    lua_pushstring(lua, luaL_typename(lua, index));
  }
}

void open_libraries(lua_State* lua) {
  luaL_checkstack(lua, 20, nullptr);
  open(lua, "_G", luaopen_base);
  change_base(lua);
  open(lua, "table", luaopen_table);
  open(lua, "utf8", luaopen_utf8);
  open(lua, "math", luaopen_math);
  change_math(lua);
  open(lua, "string", luaopen_string);
  change_string(lua);
  if (luaL_loadbufferx(lua, prelude.data(), prelude.size(), "=(library)", "t") != LUA_OK)
    lua_error(lua);
  lua_call(lua, 0, 0);
}

} // namespace rubicon::script
