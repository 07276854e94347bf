#include "script/program.hpp"

#include <stdexcept>
#include <utility>

#include <lua5.4/lauxlib.h>
#include <lua5.4/lua.h>

#include "script/commands.hpp"
#include "script/state.hpp"

namespace rubicon::script {

namespace {

void push(lua_State* lua, bool x) {
  lua_pushboolean(lua, x ? 1 : 0);
}
void push(lua_State* lua, communication::status x) {
  push(lua, x == communication::SUCCESS);
}
void push(lua_State* lua, lua_Integer x) {
  lua_pushinteger(lua, x);
}
void push(lua_State* lua, std::string_view x) {
  lua_pushlstring(lua, x.data(), x.size());
}
void push(lua_State* lua, byte_view x) {
  lua_pushlstring(lua, reinterpret_cast<const char*>(x.data()), x.size());
}
void push(lua_State* lua, std::span<const std::int16_t> x) {
  lua_createtable(lua, static_cast<int>(x.size()), 0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    lua_pushinteger(lua, x[i]);
    lua_rawseti(lua, -2, static_cast<lua_Integer>(i + 1));
  }
}
void push(lua_State* lua, std::span<const communication::output_wanted> x) {
  lua_createtable(lua, static_cast<int>(x.size()), 0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    lua_createtable(lua, 0, 2);
    lua_pushinteger(lua, x[i].channel);
    lua_setfield(lua, -2, "channel");
    lua_pushinteger(lua, x[i].period.count());
    lua_setfield(lua, -2, "period_ms");
    lua_rawseti(lua, -2, static_cast<lua_Integer>(i + 1));
  }
}

lua_Integer whole(std::uint32_t x) {
  return x;
}

} // namespace

std::shared_ptr<const apps::application_kind>
make_kind(std::shared_ptr<const program_config> config, std::size_t streams) {
  apps::application_kind x;
  x.name = "lua";
  x.streams = streams;
  x.make = [config = std::move(config)](const apps::settings&, random_stream rng) {
    return std::make_unique<program>(config, rng);
  };
  return std::make_shared<const apps::application_kind>(std::move(x));
}

program::program(std::shared_ptr<const program_config> config, random_stream rng)
    : config_(std::move(config)),
      wants_ticks_(config_->script.text.find("clock_tick") != std::string::npos),
      lua_(std::make_unique<state>(config_->most, rng, [this](lua_State* lua) {
        add_commands(lua, *this);
        lua_newtable(lua);
        for (const auto& [name, value] : config_->values) {
          if (lua_Integer whole = 0;
              lua_numbertointeger(value, &whole) && static_cast<double>(whole) == value)
            lua_pushinteger(lua, whole);
          else
            lua_pushnumber(lua, value);
          lua_setfield(lua, -2, name.c_str());
        }
        lua_setglobal(lua, "settings");
      })) {}

program::~program() = default;

void program::on_start(instant now) {
  own_.begin_event();
  ++events_;
  starts_at_ = now;
  if (!lua_->load(config_->script) || !lua_->call(0))
    throw_failure();
  starts_at_.reset();
}

instant program::now() {
  return starts_at_ ? *starts_at_ : layer().now(); // a node that starts has no time yet
}

/// Inside a command of the script the failure ends it when the command returns.
void program::throw_failure() const {
  if (!lua_->runs())
    throw std::runtime_error(lua_->failure());
}

void program::do_event(const std::function<void(lua_State*)>& what) {
  if (lua_->has_failed())
    return;
  if (!lua_->runs())
    own_.begin_event();
  if (!lua_->run(what))
    throw_failure();
}

template <class... Args>
void program::call(const char* event, const Args&... arguments) {
  do_event([&](lua_State* lua) {
    if (lua_getglobal(lua, event) != LUA_TFUNCTION)
      return;
    ++events_;
    (push(lua, arguments), ...);
    lua_call(lua, sizeof...(arguments), 0);
  });
}

// -- timers

std::optional<instant> program::deadline() const {
  return lua_->has_failed() ? std::nullopt : own_.deadline();
}

void program::on_time(instant now) {
  for (const auto number : own_.due(now)) {
    const auto expired = own_.expire(number, now);
    if (!expired)
      continue; // another one has ended it
    do_event([&](lua_State* lua) {
      ++events_;
      lua_rawgeti(lua, LUA_REGISTRYINDEX, expired->function);
      if (expired->is_last)
        luaL_unref(lua, LUA_REGISTRYINDEX, expired->function);
      lua_call(lua, 0, 0);
    });
  }
}

// -- what it reports

std::vector<apps::figure> program::figures() const {
  std::vector<apps::figure> all{{"events", static_cast<double>(events_)},
                                {"instructions", static_cast<double>(100 * lua_->steps())}};
  all.insert(all.end(), own_.figures().begin(), own_.figures().end());
  return all;
}

// -- events

void program::createSynChannelOutDone(int channel, communication::status success) {
  call("createSynChannelOutDone", lua_Integer{channel}, success);
}
void program::createSynChannelInDone(int channel, communication::status success) {
  call("createSynChannelInDone", lua_Integer{channel}, success);
}
void program::syn_input_update(int channel, std::uint8_t index, synaptic::input_status status) {
  call("syn_input_update", lua_Integer{channel}, whole(index),
       status == synaptic::input_status::updated);
}
void program::clock_tick(std::uint32_t currentClock) {
  call("clock_tick", whole(currentClock));
}
void program::synChannelFailed(int channel) {
  call("synChannelFailed", lua_Integer{channel});
}
void program::openRemoteDone(int stream_desc, std::uint16_t symbolic_name,
                             communication::status success) {
  call("openRemoteDone", lua_Integer{stream_desc}, whole(symbolic_name), success);
}
void program::readDone(int desc, byte_view buf, communication::status success) {
  call("readDone", lua_Integer{desc}, buf, success);
}
void program::ack(communication::status success) {
  call("ack", success);
}
void program::ackOf(std::uint32_t number, communication::status success) {
  call("ackOf", whole(number), success);
}
void program::receive(communication::island_octet island, std::uint16_t mote, byte_view buf,
                      std::uint8_t am_type, communication::status success) {
  call("receive", whole(island), whole(mote), buf, whole(am_type), success);
}
void program::receiveFrom(mote_address source, byte_view buf, std::uint8_t am_type) {
  call("receive", whole(source.island.value), whole(source.mote.value), buf, whole(am_type), true);
}
void program::outputsWanted(std::span<const communication::output_wanted> all) {
  call("outputsWanted", all);
}
void program::transducersRead(std::span<const std::int16_t> counts, std::uint32_t time_ms) {
  call("transducersRead", counts, whole(time_ms));
}
void program::actuatorChanged(std::string_view name, std::uint8_t state, bool obeyed) {
  call("actuatorChanged", name, whole(state), obeyed);
}
void program::initCommunicationsDone(communication::status success) {
  call("initCommunicationsDone", success);
}
void program::joined(communication::island_octet island, std::uint16_t mote,
                     communication::status success) {
  call("joined", whole(island), whole(mote), success);
}
void program::moteJoined(std::uint16_t mote, byte_view description) {
  call("moteJoined", whole(mote), description);
}

} // namespace rubicon::script
