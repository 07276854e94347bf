// The libraries that scripts have: those of Lua, without what is not the same on every machine,
// what has no bound, and what reaches the machine itself (docs/lua.md).
#pragma once

struct lua_State;

namespace rubicon::script {

/// Sets the globals of a new state.
void open_libraries(lua_State* lua);

/// The text of a value: no address, and the same for each `nan`. Leaves the stack as it is, with
/// the text on top.
void push_text(lua_State* lua, int index);

/// The libraries `math` and `string`, on top of the stack as Lua has them.
void change_math(lua_State* lua);
void change_string(lua_State* lua);

} // namespace rubicon::script
