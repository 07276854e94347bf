#include <utility>

#include "config/mote_readers.hpp"

namespace rubicon::config {

namespace {

constexpr duration every_min = 10ms;
constexpr duration every_max = 24h * 10;
constexpr whole<std::uint16_t> message_channel{0, 255}; // it is the AM type too

std::vector<std::pair<std::string_view, mote::quantity>> quantities() {
  std::vector<std::pair<std::string_view, mote::quantity>> words;
  for (unsigned i = 0; i <= static_cast<unsigned>(mote::quantity::sound); ++i)
    words.emplace_back(word_of(static_cast<mote::quantity>(i)), static_cast<mote::quantity>(i));
  return words;
}

placed_app read_sampler(table_reader& in) {
  sampler_app app;
  placed_app out;
  std::vector<located<mote::quantity>> found;
  in.required("transducers", list_of<word<mote::quantity>>{{quantities()}, 1, 8}, found);
  in.optional("every", time_span{every_min, every_max}, app.every);
  in.optional("jitter", time_span{0s, every_max}, app.jitter);
  in.optional("channel", message_channel, app.channel);
  in.optional("reliable", flag{}, app.reliable);
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
  in.optional("channel", message_channel, app.channel);
  return {std::move(app), {}, {in.at("actuator")}};
}

placed_app read_messenger(table_reader& in, const directory& names) {
  messenger_app app;
  in.required("to", mote_name{names}, app.to);
  in.required("text", text{}, app.text);
  in.optional("every", time_span{every_min, every_max}, app.every);
  in.optional("am_type", whole<std::uint8_t>{}, app.am_type);
  in.optional("reliable", flag{}, app.reliable);
  return {std::move(app), {}, {}};
}

placed_app read_listener(table_reader& in) {
  listener_app app;
  in.optional("am_type", whole<std::uint8_t>{}, app.am_type);
  return {app, {}, {}};
}

} // namespace

std::vector<placed_app> read_mote_apps(table_reader& in, const directory& names) {
  std::vector<placed_app> out;
  const auto add = [&out](const table_reader& x, std::string_view channel_key, placed_app app) {
    app.channel_at = x.at(channel_key);
    out.push_back(std::move(app));
  };
  in.tables("apps", "apps of a mote", [&](table_reader& x) {
    x.one_of("app",
             {{"sampler", [&](table_reader& y) { add(y, "channel", read_sampler(y)); }},
              {"actuator", [&](table_reader& y) { add(y, "channel", read_actuator_app(y)); }},
              {"messenger", [&](table_reader& y) { add(y, "am_type", read_messenger(y, names)); }},
              {"listener", [&](table_reader& y) { add(y, "am_type", read_listener(y)); }}});
  });
  return out;
}

} // namespace rubicon::config
