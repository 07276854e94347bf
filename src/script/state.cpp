#include "script/state.hpp"

#include <cassert>
#include <new>

#include <lua5.4/lauxlib.h>

#include "script/libraries.hpp"

namespace rubicon::script {

namespace {

constexpr int step = 100; ///< instructions between two calls of the hook

void* allocate(void* memory, void* old, std::size_t old_size, std::size_t size) {
  return static_cast<heap*>(memory)->resize(old, old_size, size);
}

int traceback(lua_State* lua) {
  const char* text = lua_tostring(lua, 1);
  if (text == nullptr)
    text = lua_pushfstring(lua, "an error without text, of type %s", luaL_typename(lua, 1));
  luaL_traceback(lua, lua, text, 1);
  return 1;
}

/// A traceback in one line.
std::string one_line(std::string_view text) {
  constexpr std::string_view heading = "\nstack traceback:";
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.substr(i).starts_with(heading))
      i += heading.size();
    if (i < text.size() && text[i] == '\n')
      out += "; ";
    else if (i < text.size() && text[i] != '\t')
      out += text[i];
  }
  return out;
}

} // namespace

state::state(const limits& most, random_stream rng, const work& more) : most_(most), rng_(rng) {
  lua_ = lua_newstate(allocate, &heap_);
  if (lua_ == nullptr)
    throw std::bad_alloc();
  *static_cast<state**>(lua_getextraspace(lua_)) = this;
  const work all = [&](lua_State* lua) {
    open_libraries(lua);
    if (more)
      more(lua);
  };
  lua_pushcfunction(lua_, do_work);
  lua_pushlightuserdata(lua_, const_cast<work*>(&all));
  [[maybe_unused]] const int status = lua_pcall(lua_, 1, 0, 0);
  assert(status == LUA_OK);
  lua_gc(lua_, LUA_GCCOLLECT);
  heap_.limit(most_.memory);
  lua_sethook(lua_, on_count, LUA_MASKCOUNT, step);
}

state::~state() {
  lua_close(lua_);
}

state& state::of(lua_State* lua) {
  return **static_cast<state**>(lua_getextraspace(lua));
}

bool state::load(const source& x) {
  if (has_failed())
    return false;
  const auto name = '@' + x.name;
  if (const auto line = line_of_power(x.text); line > 0)
    failure_ = x.name + ':' + std::to_string(line) +
               ": the operator ^ is not the same on every machine: use math.pow";
  else if (const int status =
               luaL_loadbufferx(lua_, x.text.data(), x.text.size(), name.c_str(), "t");
           status != LUA_OK)
    fail(status);
  return !has_failed();
}

bool state::call(int arguments) {
  if (has_failed()) {
    lua_pop(lua_, arguments + 1);
    return false;
  }
  if (depth_++ == 0)
    steps_max_ = steps_ + most_.instructions / step;
  const int at = lua_gettop(lua_) - arguments;
  lua_pushcfunction(lua_, traceback);
  lua_insert(lua_, at);
  const int status = lua_pcall(lua_, arguments, 0, at);
  --depth_;
  if (status != LUA_OK)
    fail(status);
  lua_settop(lua_, at - 1);
  return !has_failed();
}

bool state::run(const work& what) {
  if (has_failed() || lua_checkstack(lua_, LUA_MINSTACK) == 0)
    return false;
  lua_pushcfunction(lua_, do_work);
  lua_pushlightuserdata(lua_, const_cast<work*>(&what));
  return call(1);
}

int state::do_work(lua_State* lua) {
  const auto& what = *static_cast<const work*>(lua_touserdata(lua, 1));
  lua_settop(lua, 0);
  what(lua);
  return 0;
}

void state::fail(int status) {
  const char* text = lua_type(lua_, -1) == LUA_TSTRING ? lua_tostring(lua_, -1) : nullptr;
  if (has_failed())
    return; // of an event that it has brought about
  if (status == LUA_ERRMEM)
    failure_ = "more than " + std::to_string(most_.memory) + " octets of memory";
  else
    failure_ = text == nullptr ? "an error without text" : one_line(text);
}

void state::charge(std::uint64_t instructions) {
  charged_ += instructions;
  steps_ += charged_ / step;
  charged_ %= step;
  check_goes_on();
}

void state::check_goes_on() {
  if (steps_ <= steps_max_ && !has_failed())
    return;
  luaL_where(lua_, 0);
  if (lua_rawlen(lua_, -1) == 0) { // in a function of a library
    lua_pop(lua_, 1);
    luaL_where(lua_, 1);
  }
  lua_pushfstring(lua_, "more than %d instructions in one event",
                  static_cast<int>(most_.instructions));
  lua_concat(lua_, 2);
  lua_error(lua_);
}

void state::on_count(lua_State* lua, lua_Debug*) {
  state& self = of(lua);
  ++self.steps_;
  self.check_goes_on();
}

} // namespace rubicon::script
