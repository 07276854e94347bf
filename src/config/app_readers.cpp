#include <utility>

#include "config/application_readers.hpp"
#include "config/mote_readers.hpp"

namespace rubicon::config {

namespace {

constexpr duration every_min = 10ms;
constexpr duration every_max = 24h * 10;
constexpr std::uint16_t flow_channel = 0xf0; // flow::am_type

/// Channels and AM types are free but for that of the measuring apps.
template <class Channel>
void read_channel(table_reader& in, std::string_view key, Channel& out) {
  in.optional(key, whole<Channel>{0, 255}, out);
  if (out == flow_channel)
    in.problems().add(in.at(key), "channel 240 is that of the apps sender, relay and receiver");
}

placed_app read_sampler(table_reader& in) {
  sampler_app app;
  placed_app out;
  std::vector<located<mote::quantity>> found;
  auto readable = quantities();
  readable.emplace_back(word_of(mote::quantity::signal), mote::quantity::signal);
  in.required("transducers", list_of<word<mote::quantity>>{{readable}, 1, 8}, found);
  in.optional("every", time_span{every_min, every_max}, app.every);
  in.optional("jitter", time_span{0s, every_max}, app.jitter);
  read_channel(in, "channel", app.channel);
  in.optional("reliable", flag{}, app.reliable);
  in.optional("only_subscribed", flag{}, app.only_subscribed);
  app.every_min = std::min(app.every_min, app.every);
  if (in.optional("every_min", time_span{every_min, every_max}, app.every_min) &&
      app.every_min > app.every)
    in.problems().add(in.at("every_min"), "`every_min` must not be longer than `every`, which is " +
                                              to_text(app.every));
  in.optional("stamped", flag{}, app.stamped);
  if (in.sound() && app.jitter > app.every)
    in.problems().add(in.at("jitter"),
                      "`jitter` must not be longer than `every`, which is " + to_text(app.every));
  claims<mote::quantity> listed;
  for (const auto& each : found) {
    listed.claim(each.value, "transducer `" + std::string(word_of(each.value)) + '`', each.at,
                 in.problems(), "is already listed");
    out.needs_at.push_back(each.at);
  }
  app.transducers = values_of(std::move(found));
  out.app = std::move(app);
  return out;
}

placed_app read_actuator_app(table_reader& in) {
  actuator_app app;
  in.required("actuator", name_text{}, app.actuator);
  read_channel(in, "channel", app.channel);
  return {std::move(app), {}, {in.at("actuator")}, {}};
}

placed_app read_messenger(table_reader& in, const directory& names) {
  messenger_app app;
  if (in.required("to", mote_name{names}, app.to)) {
    const auto* island = names.find(app.to.island);
    if (island != nullptr && !island->has_gateway)
      in.problems().add(in.at("to"), "a mote of an island with stack = \"mac\" takes no messages");
  }
  in.required("text", text{}, app.text);
  in.optional("every", time_span{every_min, every_max}, app.every);
  read_channel(in, "am_type", app.am_type);
  in.optional("reliable", flag{}, app.reliable);
  return {std::move(app), {}, {}, {}};
}

placed_app read_listener(table_reader& in) {
  listener_app app;
  read_channel(in, "am_type", app.am_type);
  return {app, {}, {}, {}};
}

void read_end(table_reader& in, std::string_view key, const flow_end_name& kind, bool required,
              placed_app& out) {
  flow_end end;
  const bool found = required ? in.required(key, kind, end) : in.optional(key, kind, end);
  out.ends.push_back({found ? std::optional(end) : std::nullopt, in.at(key)});
}

/// A key that means nothing with this pattern.
void refuse_with(const table_reader& in, std::string_view key, std::string_view pattern) {
  if (in.has(key))
    in.problems().add(in.at(key), '`' + std::string(key) + "` means nothing with pattern = \"" +
                                      std::string(pattern) + '"');
}

void read_times(table_reader& in, flow::sender_config& app) {
  constexpr duration interval_min = 1ms;
  const word<flow::arrivals> patterns{{{"periodic", flow::arrivals::periodic},
                                       {"poisson", flow::arrivals::poisson},
                                       {"saturated", flow::arrivals::saturated}}};
  in.optional("pattern", patterns, app.pattern);
  in.optional("every", time_span{interval_min, every_max}, app.every);
  in.optional("jitter", time_span{0s, every_max}, app.jitter);
  in.optional("start", time_span{}, app.start);
  in.optional("stop", time_span{}, app.stop);
  in.optional("count", whole<std::uint64_t>{1, INT64_MAX}, app.count);
  if (!in.sound())
    return;
  if (app.pattern == flow::arrivals::saturated) {
    refuse_with(in, "every", "saturated");
    refuse_with(in, "jitter", "saturated");
  }
  if (app.pattern == flow::arrivals::poisson)
    refuse_with(in, "jitter", "poisson");
  else if (app.jitter > app.every)
    in.problems().add(in.at("jitter"),
                      "`jitter` must not be longer than `every`, which is " + to_text(app.every));
  if (app.stop && *app.stop <= app.start.value_or(0s))
    in.problems().add(in.at("stop"), "`stop` must be later than `start`, which is " +
                                         to_text(app.start.value_or(0s)));
}

placed_app read_sender(table_reader& in, const directory& names) {
  flow::sender_config app;
  placed_app out;
  read_end(in, "to", {names, true}, true, out);
  read_end(in, "via", {names, false}, false, out);
  in.optional("payload", whole<std::size_t>{flow::payload_min, flow::payload_max}, app.payload);
  read_times(in, app);
  in.optional("ack", flag{}, app.ack);
  if (out.ends[0].value && out.ends[0].value->mote == broadcast_mote) {
    if (in.has("via"))
      in.problems().add(in.at("via"), "a broadcast goes to whoever hears it, not `via` a relay");
    if (in.has("ack") && app.ack)
      in.problems().add(in.at("ack"), "a broadcast is never acknowledged");
    app.ack = false;
  }
  out.app = app;
  return out;
}

placed_app read_relay(table_reader& in, const directory& names) {
  flow::relay_config app;
  placed_app out;
  read_end(in, "next", {names, false}, true, out);
  in.optional("ack", flag{}, app.ack);
  out.app = app;
  return out;
}

/// Whether the actor that a program is in is its mote's or its own.
enum class program_place : std::uint8_t { mote, actor };

placed_app read_program(table_reader& in, const program_kind& kind) {
  auto found = kind.second(in);
  auto where = program_place::mote;
  in.optional("place",
              word<program_place>{{{"mote", program_place::mote}, {"actor", program_place::actor}}},
              where);
  placed_app out{std::move(found.app), {}, std::move(found.needs_at), {}};
  if (where == program_place::actor)
    out.app = separate_app{std::get<apps::app_config>(std::move(out.app))};
  return out;
}

} // namespace

std::vector<placed_app> read_mote_apps(table_reader& in, const directory& names) {
  std::vector<placed_app> out;
  const auto add = [&out](const table_reader& x, std::string_view channel_key, placed_app app) {
    app.channel_at = x.at(channel_key);
    out.push_back(std::move(app));
  };
  in.tables("apps", "apps of a mote", [&](table_reader& x) {
    std::vector<std::pair<std::string_view, table_reader::part_reader>> choices{
        {"sampler", [&](table_reader& y) { add(y, "channel", read_sampler(y)); }},
        {"actuator", [&](table_reader& y) { add(y, "channel", read_actuator_app(y)); }},
        {"messenger", [&](table_reader& y) { add(y, "am_type", read_messenger(y, names)); }},
        {"listener", [&](table_reader& y) { add(y, "am_type", read_listener(y)); }}};
    for (const auto& kind : mote_programs(in, names))
      choices.emplace_back(kind.first,
                           [&add, kind](table_reader& y) { add(y, "app", read_program(y, kind)); });
    choices.insert(choices.end(),
                   {{"sender", [&](table_reader& y) { add(y, "app", read_sender(y, names)); }},
                    {"relay", [&](table_reader& y) { add(y, "app", read_relay(y, names)); }},
                    {"receiver", [&](table_reader& y) {
                       add(y, "app", {flow::receiver_config{}, {}, {}, {}});
                     }}});
    x.one_of("app", choices);
  });
  return out;
}

} // namespace rubicon::config
