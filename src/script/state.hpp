// A Lua state with limits, in which a script gives the same results on every machine (docs/lua.md).
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <lua5.4/lua.h>

#include "core/numbers/random.hpp"
#include "script/heap.hpp"
#include "script/source.hpp"

namespace rubicon::script {

/// Lua is compiled as C++: its errors are exceptions, and objects on the stack are destroyed.
/// None leaves a function of this class, except where it is called from Lua.
class state {
public:
  using work = std::function<void(lua_State* lua)>;

  /// With the libraries that scripts have.
  /// @param more what else is there before the limits apply
  state(const limits& most, random_stream rng, const work& more = {});
  ~state();
  state(const state&) = delete;
  state& operator=(const state&) = delete;

  /// Whose state it is.
  [[nodiscard]] static state& of(lua_State* lua);

  [[nodiscard]] lua_State* lua() const { return lua_; }
  [[nodiscard]] random_stream& rng() { return rng_; }

  /// Compiles a script, which is then on top of the stack. @returns whether it is correct
  bool load(const source& x);

  /// Calls the function below its arguments on top of the stack, and drops what it returns.
  /// Once it has failed, nothing runs any more. @returns whether it was completed
  bool call(int arguments);

  /// Does what may raise errors of Lua; the rest as above.
  bool run(const work& what);

  [[nodiscard]] bool has_failed() const { return !failure_.empty(); }
  /// `fan.lua:3: reason; in function 'f'`; empty: none.
  [[nodiscard]] const std::string& failure() const { return failure_; }

  [[nodiscard]] bool runs() const { return depth_ > 0; }
  /// Instructions so far, in hundreds; what libraries do at length is part of it.
  [[nodiscard]] std::uint64_t steps() const { return steps_; }

  /// Counts what a function of a library does. Raises an error above the limit, as the next one
  /// does if nothing may run any more: called from Lua only.
  void charge(std::uint64_t instructions);
  void check_goes_on();

  /// A function that was called from Lua has failed, for want of memory or worse: all ends. The
  /// error is on top of the stack.
  void fail(int status);

private:
  static int do_work(lua_State* lua);
  static void on_count(lua_State* lua, lua_Debug* /*where*/);

  heap heap_;
  limits most_;
  random_stream rng_;
  lua_State* lua_ = nullptr;
  std::string failure_;
  std::uint64_t steps_ = 0;
  std::uint64_t steps_max_ = 0; ///< of this event
  std::uint64_t charged_ = 0;   ///< less than a step
  unsigned depth_ = 0;
};

} // namespace rubicon::script
