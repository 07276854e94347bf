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
void read_channel(table_reader& in, std::string_view key, Channel& out, const about& what) {
  in.optional(key, whole<Channel>{0, 255}, out, what);
  if (out == flow_channel)
    in.problems().add(in.at(key), "channel 240 is that of the apps sender, relay and receiver");
}

placed_app read_sampler(table_reader& in) {
  sampler_app app;
  placed_app out;
  std::vector<located<mote::quantity>> found;
  in.required("transducers", list_of<word<mote::quantity>>{{sampled_quantities()}, 1, 8}, found,
              {"each is a transducer of the mote, or `\"signal\"`: how strongly the mote receives "
               "its parent, the next mote or sink on the way to the gateway, in dBm; 127 before it "
               "has heard it",
               "", "array of 1 to 8 quantities"});
  in.optional("every", time_span{every_min, every_max}, app.every, "from one message to the next");
  in.optional("jitter", time_span{0s, every_max}, app.jitter,
              {"each period starts up to this much late, at random", "", "time up to `every`"});
  read_channel(in, "channel", app.channel,
               "output channel, `devices.ID.output.CHANNEL` at the gateway");
  in.optional("reliable", flag{}, app.reliable, "ask for an end-to-end acknowledgement");
  in.optional("only_subscribed", flag{}, app.only_subscribed,
              "it sends only while somebody in the PEIS network subscribes to its output tuple, by "
              "its key or a pattern that begins with `devices`");
  app.every_min = std::min(app.every_min, app.every);
  if (in.optional(
          "every_min", time_span{every_min, every_max}, app.every_min,
          {"subscribers may ask for another [period](gateway.md#of-a-gateway), but for none "
           "below this",
           "`\"100ms\"`, or `every` if that is shorter", "time from 10 ms to `every`"}) &&
      app.every_min > app.every)
    in.problems().add(in.at("every_min"), "`every_min` must not be longer than `every`, which is " +
                                              to_text(app.every));
  in.optional("stamped", flag{}, app.stamped,
              "after the counts, say when that was: 4 octets, big-endian, the low 32 bits of the "
              "[network time](gateway.md#time) in milliseconds");
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
  in.required("actuator", name_text{}, app.actuator, "an actuator of the mote");
  read_channel(in, "channel", app.channel, "input channel, and output channel of the answer");
  return {std::move(app), {}, {in.at("actuator")}, {}};
}

placed_app read_messenger(table_reader& in, const directory& names) {
  messenger_app app;
  if (in.required("to", mote_name{names}, app.to, "who gets it")) {
    const auto* island = names.find(app.to.island);
    if (island != nullptr && !island->has_gateway)
      in.problems().add(in.at("to"), "a mote of an island with stack = \"mac\" takes no messages");
  }
  in.required("text", text{}, app.text, "what is sent");
  in.optional("every", time_span{every_min, every_max}, app.every, "from one message to the next");
  read_channel(in, "am_type", app.am_type, "on which the listener waits");
  in.optional("reliable", flag{}, app.reliable, "ask for an end-to-end acknowledgement");
  return {std::move(app), {}, {}, {}};
}

placed_app read_listener(table_reader& in) {
  listener_app app;
  read_channel(in, "am_type", app.am_type, "of the messages that it counts");
  return {app, {}, {}, {}};
}

void read_end(table_reader& in, std::string_view key, const flow_end_name& kind, bool required,
              placed_app& out, const about& what) {
  flow_end end;
  const bool found =
      required ? in.required(key, kind, end, what) : in.optional(key, kind, end, what);
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
  in.optional("pattern", patterns, app.pattern,
              "one each period; independent, so far apart on average; or the next as soon as one "
              "has ended");
  in.optional("every", time_span{interval_min, every_max}, app.every, "not if saturated");
  in.optional(
      "jitter", time_span{0s, every_max}, app.jitter,
      {"each is up to this much late, at random; only if periodic", "", "time up to `every`"});
  in.optional(
      "start", time_span{}, app.start,
      {"of the first packet", "a random moment of the first `every`; if saturated, at once"});
  in.optional("stop", time_span{}, app.stop,
              {"from then on nothing is sent", "the end of the run", "time after `start`"});
  in.optional("count", whole<std::uint64_t>{1, INT64_MAX}, app.count,
              {"at most so many packets", "no limit"});
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
  read_end(
      in, "to", {names, true}, true, out,
      "the target; `\"sink\"` is the sink of the own island, `\"*\"` whoever hears it and has a "
      "receiver");
  read_end(in, "via", {names, false}, false, out, {"first hop, a relay", "the target itself"});
  in.optional("payload", whole<std::size_t>{flow::payload_min, flow::payload_max}, app.payload,
              "octets of MAC payload, TinyOS's network octet and AM type included");
  read_times(in, app);
  in.optional("ack", flag{}, app.ack,
              {"acknowledgement by the medium access", "`true`, for `\"*\"` `false`"});
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
  read_end(in, "next", {names, false}, true, out, "where to");
  in.optional("ack", flag{}, app.ack, "as of a sender");
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
              where, "[where the program runs](#place-of-a-program); on a mote only");
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
  in.tables(
      "apps", "apps of a mote",
      {"its programs; a mote's replace its type's of the same kind on the same channel or AM type, "
       "a relay its relay and a receiver its receiver, or are added; of a sink senders, relays and "
       "receivers only",
       "none"},
      [&](table_reader& x) {
        std::vector<std::pair<std::string_view, table_reader::part_reader>> choices{
            {"sampler", [&](table_reader& y) { add(y, "channel", read_sampler(y)); }},
            {"actuator", [&](table_reader& y) { add(y, "channel", read_actuator_app(y)); }},
            {"messenger", [&](table_reader& y) { add(y, "am_type", read_messenger(y, names)); }},
            {"listener", [&](table_reader& y) { add(y, "am_type", read_listener(y)); }}};
        for (const auto& kind : mote_programs(in, names))
          choices.emplace_back(
              kind.first, [&add, kind](table_reader& y) { add(y, "app", read_program(y, kind)); });
        choices.insert(choices.end(),
                       {{"sender", [&](table_reader& y) { add(y, "app", read_sender(y, names)); }},
                        {"relay", [&](table_reader& y) { add(y, "app", read_relay(y, names)); }},
                        {"receiver", [&](table_reader& y) {
                           add(y, "app", {flow::receiver_config{}, {}, {}, {}});
                         }}});
        x.one_of("app", "which program", choices);
      });
  return out;
}

} // namespace rubicon::config
