// What a script calls: the commands of the Mockup interface, timers, and what it reports.
#pragma once

struct lua_State;

namespace rubicon::script {

class program;

/// Sets the globals of a script. @param owner outlives the state
void add_commands(lua_State* lua, program& owner);

} // namespace rubicon::script
