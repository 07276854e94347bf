#include <utility>

#include "apps/app_keys.hpp"
#include "config/island/application_readers.hpp"
#include "config/island/mote_readers.hpp"
#include "tinyos/program_keys.hpp"
#include "traffic/flow_keys.hpp"

namespace rubicon::config {

namespace {

constexpr std::uint16_t flow_channel = 0xf0; // traffic::am_type

/// Channels and AM types are free but for that of the measuring apps.
void check_channel(const table_reader& in, std::string_view key, std::uint16_t channel) {
  if (channel == flow_channel)
    in.problems().add(in.at(key), "channel 240 is that of the apps sender, relay and receiver");
}

/// Transducers of a sampler, with the places that checks need.
struct sampled_quantities {
  std::vector<located<device::quantity>> transducers;
};

auto sampled_quantity_keys() {
  return keys::of(keys::required(
      "transducers", &sampled_quantities::transducers, list_of<quantity_name>{{true}, 1, 8},
      {"each is a transducer of the mote, or `\"signal\"`: signal strength at which the "
       "mote receives its parent, the next mote or sink on the route to the gateway, in "
       "dBm; 127 before the first frame",
       "", "array of 1 to 8 quantities"}));
}

auto period_min_keys() {
  return keys::of(
      keys::optional("every_min", &sampler_app::every_min, apps::report_period,
                     {"shortest [period](gateway.md#of-a-gateway) that subscribers may request",
                      "`\"100ms\"`, or `every` if that is shorter", "time from 10 ms to `every`"}));
}

/// Dead bands of a sampler, by the names of quantities.
struct dead_bands {
  named_values<double> bands;
};

/// A table, by quantity.
struct band_table {
  using type = named_values<double>;
  std::string like; ///< one of the quantities

  [[nodiscard]] std::optional<type> read(const node& x, const asker& who) const {
    if (x.as<node_table>() == nullptr)
      return who.refuse(x, "a table by quantity, as in " + table_of(like, x));
    return config::read(pairs_of<real>{{0}}, x, who);
  }
  [[nodiscard]] static form takes() { return form_of(pairs_of<real>{{0}}); }
};

auto dead_band_keys(const std::string& like) {
  return keys::of(keys::optional(
      "dead_band", &dead_bands::bands, band_table{like},
      {"it samples every period, but sends only when one of these values differs by at least this "
       "much from the one last sent; 0: when it has changed",
       "every sample is sent", "`{ temperature = 0.5 }`, some of the quantities, in their units"}));
}

auto silence_keys() {
  return keys::of(keys::optional(
      "silence_max", &sampler_app::silence_max, apps::report_period,
      {"with `dead_band`: longest time between two messages, so that a steady value can be "
       "distinguished from an absent mote",
       "ten times `every`", "time from `every`"}));
}

/// dead_band and silence_max of a sampler whose other keys are read.
void read_dead_band(table_reader& in, sampler_app& app, placed_app& out) {
  dead_bands given;
  in.all(given, dead_band_keys(app.transducers.empty()
                                   ? "temperature"
                                   : in.shared().quantities.word_of(app.transducers.front())));
  const auto& bands = given.bands;
  app.silence_max = 10 * app.every;
  in.all(app, silence_keys());
  if (in.has("silence_max") && !in.has("dead_band"))
    in.problems().add(in.at("silence_max"), "`silence_max` has no effect without a `dead_band`");
  if (app.silence_max < app.every)
    in.problems().add(in.at("silence_max"), "`silence_max` must not be shorter than `every`, which "
                                            "is " +
                                                to_text(app.every));
  if (!in.is_good("dead_band") || !in.sound()) {
    app.silence_max = 0s;
    return;
  }
  out.dead_band.resize(app.transducers.size());
  for (const auto& [name, value] : bands) {
    const auto at = std::ranges::find(app.transducers, name.value, [&in](device::quantity x) {
      return in.shared().quantities.word_of(x);
    });
    if (at == app.transducers.end())
      in.problems().add(name.at, "`" + name.value + "` is not among the `transducers`");
    else
      out.dead_band[static_cast<std::size_t>(at - app.transducers.begin())] = value;
  }
}

placed_app read_sampler(table_reader& in) {
  sampler_app app;
  placed_app out;
  sampled_quantities sampled;
  in.all(sampled, sampled_quantity_keys());
  auto& found = sampled.transducers;
  in.all(app);
  check_channel(in, "channel", app.channel);
  app.every_min = std::min(app.every_min, app.every);
  in.all(app, period_min_keys());
  if (in.is_good("every_min") && app.every_min > app.every)
    in.problems().add(in.at("every_min"), "`every_min` must not be longer than `every`, which is " +
                                              to_text(app.every));
  if (in.sound() && app.jitter > app.every)
    in.problems().add(in.at("jitter"),
                      "`jitter` must not be longer than `every`, which is " + to_text(app.every));
  uniqueness<device::quantity> listed;
  for (const auto& each : found) {
    listed.add(each.value, "transducer `" + in.shared().quantities.word_of(each.value) + '`',
               each.at, in.problems(), "is already listed");
    out.needs_at.push_back(each.at);
  }
  app.transducers = values_of(std::move(found));
  read_dead_band(in, app, out);
  out.app = std::move(app);
  return out;
}

placed_app read_actuator_app(table_reader& in) {
  actuator_app app;
  in.all(app);
  check_channel(in, "channel", app.channel);
  return {std::move(app), {}, {in.at("actuator")}, {}};
}

placed_app read_messenger(table_reader& in) {
  messenger_app app;
  in.all(app);
  check_channel(in, "am_type", app.am_type);
  const auto* island = in.shared().names->find(app.to.island);
  if (island != nullptr && !island->is_joined)
    in.problems().add(
        in.at("to"),
        "a mote of an island with stack = \"mac\" or with a base station accepts no messages");
  return {std::move(app), {}, {}, {}};
}

placed_app read_listener(table_reader& in) {
  listener_app app;
  in.all(app);
  check_channel(in, "am_type", app.am_type);
  return {app, {}, {}, {}};
}

/// Where packets of a flow go.
struct flow_target {
  flow_end end;
};

void read_end(table_reader& in, std::string_view key, const flow_end_name& kind, bool required,
              placed_app& out, const about& what) {
  auto one = keys::optional(key, &flow_target::end, kind, what);
  one.is_required = required;
  flow_target target;
  in.all(target, keys::of(one));
  out.ends.push_back({in.is_good(key) ? std::optional(target.end) : std::nullopt, in.at(key)});
}

/// A key that means nothing with this pattern.
void refuse_with(const table_reader& in, std::string_view key, std::string_view pattern) {
  if (in.has(key))
    in.problems().add(in.at(key), '`' + std::string(key) + "` has no effect with pattern = \"" +
                                      std::string(pattern) + '"');
}

void check_times(const table_reader& in, const traffic::sender_config& app) {
  if (!in.sound())
    return;
  if (app.pattern == traffic::arrivals::saturated) {
    refuse_with(in, "every", "saturated");
    refuse_with(in, "jitter", "saturated");
  }
  if (app.pattern == traffic::arrivals::poisson)
    refuse_with(in, "jitter", "poisson");
  else if (app.jitter > app.every)
    in.problems().add(in.at("jitter"),
                      "`jitter` must not be longer than `every`, which is " + to_text(app.every));
  if (app.stop && *app.stop <= app.start.value_or(0s))
    in.problems().add(in.at("stop"), "`stop` must be later than `start`, which is " +
                                         to_text(app.start.value_or(0s)));
}

placed_app read_sender(table_reader& in) {
  traffic::sender_config app;
  placed_app out;
  read_end(in, "to", {true}, true, out,
           "the target; `\"sink\"` is the sink of the own island, `\"*\"` every radio that "
           "receives it and has a receiver");
  read_end(in, "via", {}, false, out, {"first hop, a relay", "the target itself"});
  in.all(app);
  check_times(in, app);
  if (out.ends[0].value && out.ends[0].value->mote == broadcast_mote) {
    if (in.has("via"))
      in.problems().add(in.at("via"), "a broadcast goes to all radios in range, not `via` a relay");
    if (in.has("ack") && app.ack)
      in.problems().add(in.at("ack"), "a broadcast is never acknowledged");
    app.ack = false;
  }
  out.app = app;
  return out;
}

placed_app read_relay(table_reader& in) {
  traffic::relay_config app;
  placed_app out;
  read_end(in, "next", {}, true, out, "radio to which it passes packets on");
  in.all(app);
  out.app = app;
  return out;
}

placed_app read_oscilloscope(table_reader& in) {
  tinyos::program_config app{.kind = tinyos::program_kind::oscilloscope, .every = 256ms};
  in.all(app, tinyos::oscilloscope_keys());
  return {app, {}, {in.at("transducer")}, {}};
}

placed_app read_counter(table_reader& in, tinyos::program_kind kind) {
  tinyos::program_config app{.kind = kind};
  in.all(app, tinyos::counter_keys());
  return {app, {}, {}, {}};
}

/// Whether the actor that a program is in is its mote's or its own.
enum class program_place : std::uint8_t { mote, actor };

struct placed_actor {
  program_place where = program_place::mote;
};

auto program_place_keys() {
  return keys::of(keys::optional(
      "place", &placed_actor::where,
      word<program_place>{{{"mote", program_place::mote}, {"actor", program_place::actor}}},
      "[where the program runs](#place-of-a-program); on a mote only"));
}

placed_app read_program(table_reader& in, const program_kind& kind) {
  auto found = kind.second(in);
  placed_actor place;
  in.all(place, program_place_keys());
  placed_app out{std::move(found.app), {}, std::move(found.needs_at), {}};
  if (place.where == program_place::actor)
    out.app = separate_app{std::get<apps::app_config>(std::move(out.app))};
  return out;
}

} // namespace

std::vector<placed_app> read_mote_apps(table_reader& in) {
  std::vector<placed_app> out;
  const auto add = [&out](const table_reader& x, std::string_view channel_key, placed_app app) {
    app.channel_at = x.at(channel_key);
    out.push_back(std::move(app));
  };
  in.tables("apps", "apps of a mote",
            {"its programs; those of a mote are added to those of its type, or replace one of the "
             "same kind on the same channel or AM type; a relay or a receiver replaces the type's, "
             "a member that of the same group, and a plain program of TinyOS the one of its kind; "
             "a sink has senders, relays and receivers only",
             "none"},
            [&](table_reader& x) {
              std::vector<std::pair<std::string_view, table_reader::part_reader>> choices{
                  {"sampler", [&](table_reader& y) { add(y, "channel", read_sampler(y)); }},
                  {"actuator", [&](table_reader& y) { add(y, "channel", read_actuator_app(y)); }},
                  {"messenger", [&](table_reader& y) { add(y, "am_type", read_messenger(y)); }},
                  {"listener", [&](table_reader& y) { add(y, "am_type", read_listener(y)); }}};
              for (const auto& kind : mote_programs(in))
                choices.emplace_back(kind.first, [&add, kind](table_reader& y) {
                  add(y, "app", read_program(y, kind));
                });
              choices.insert(
                  choices.end(),
                  {{"member", [&](table_reader& y) { add(y, "group", read_member(y)); }},
                   {"sender", [&](table_reader& y) { add(y, "app", read_sender(y)); }},
                   {"relay", [&](table_reader& y) { add(y, "app", read_relay(y)); }},
                   {"receiver",
                    [&](table_reader& y) {
                      add(y, "app", {traffic::receiver_config{}, {}, {}, {}});
                    }},
                   {"oscilloscope", [&](table_reader& y) { add(y, "app", read_oscilloscope(y)); }},
                   {"blink",
                    [&](table_reader& y) {
                      add(y, "app", read_counter(y, tinyos::program_kind::blink));
                    }},
                   {"count", [&](table_reader& y) {
                      add(y, "app", read_counter(y, tinyos::program_kind::count));
                    }}});
              x.one_of("app", "program", choices);
            });
  return out;
}

} // namespace rubicon::config
