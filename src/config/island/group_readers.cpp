// [smepp] and app = "member": SMEPP Light.
#include <algorithm>
#include <array>
#include <utility>

#include "config/file_readers.hpp"
#include "config/plan/secret_key.hpp"
#include "config/plan/secrets.hpp"
#include "core/numbers/random.hpp"
#include "smepp/member_keys.hpp"

namespace rubicon::config {

namespace {

constexpr duration period_max = 65s;

smepp::key drawn_key(std::uint64_t seed, const std::string& what) {
  random_stream rng(seed, "smepp/" + what);
  std::array<std::uint8_t, smepp::key::size> octets{};
  for (auto& x : octets)
    x = static_cast<std::uint8_t>(rng.next());
  return smepp::key(octets);
}

void check_milliseconds(const table_reader& in, std::string_view key, duration x) {
  if (in.sound() && x % 1ms != 0ns)
    in.problems().add(in.at(key), "`" + std::string(key) + "` must be whole milliseconds");
}

auto group_keys() {
  using x = smepp::group_description;
  return keys::of(
      keys::required("name", &x::name, text{x::name_max},
                     "name that `group` of the app `member` refers to"),
      keys::optional("closed", &x::is_closed, flag{}, "only motes with the master key may enter"),
      keys::optional("private", &x::is_private, flag{},
                     "only motes with the master key may find it"));
}

/// Key of a group, whether or not the group needs one.
struct group_secret {
  std::optional<smepp::key> master;
};

auto group_secret_keys(const std::string& group) {
  return keys::of(keys::optional(
      "master_key", &group_secret::master, secret_key{master_key_name(group)},
      {"key to enter a closed group and to find a private one; the motes with a `member` "
       "of the group have it",
       "drawn from the seed, which is not secret"}));
}

auto management_keys() {
  using x = decltype(smepp::group_description::management);
  return keys::of(
      keys::optional("period", &x::period, time_span{0s, period_max},
                     "period of management windows, in which radios of members are on for control "
                     "messages; 0: always"),
      keys::optional("window", &x::length, time_span{60ms, period_max}, "length of such a window"));
}

auto network_secret_keys() {
  using x = smepp::group_settings;
  return keys::of(
      keys::optional("network_key", &x::network_key, secret_key{"smepp.network_key"},
                     {"encrypts all frames", "drawn from the seed, which is not secret"})
          .changeable(),
      keys::optional("network_mac", &x::network_mac, secret_key{"smepp.network_mac"},
                     {"authenticates them", "drawn from the seed, which is not secret"})
          .changeable());
}

auto sender_secret_keys() {
  using x = smepp::group_settings;
  return keys::of(
      keys::optional("authenticate", &x::authenticates_sender,
                     word<bool>{{{"group", false}, {"sender", true}}},
                     "proof that an event carries: that a member has raised it, or which one, by "
                     "a key that it shares with the subscriber"),
      keys::optional("pairwise_key", &x::pairwise_root, secret_key{"smepp.pairwise_key"},
                     {"secret from which pairwise keys of motes are derived; no mote has it",
                      "drawn from the seed, which is not secret"}));
}

auto member_group_keys() {
  return keys::of(keys::required("group", &smepp::member_config::group,
                                 text{smepp::group_description::name_max}, "its name"));
}

smepp::group_description read_group(table_reader& in, std::uint64_t seed, name_uniqueness& names) {
  smepp::group_description out;
  in.all(out, group_keys());
  if (in.is_good("name"))
    names.add(out.name, "group", in.at("name"), in.problems());
  group_secret secret;
  in.all(secret, group_secret_keys(out.name));
  if (in.has("master_key") && in.sound() && !out.is_closed && !out.is_private)
    in.problems().add(in.at("master_key"),
                      "`master_key` has no effect on a group that is neither closed nor private");
  if (out.is_closed || out.is_private)
    out.master = secret.master ? secret.master : drawn_key(seed, "group/" + out.name);
  in.all(out.management, management_keys());
  check_milliseconds(in, "period", out.management.period);
  check_milliseconds(in, "window", out.management.length);
  if (in.sound() && !smepp::is_name(out.name, smepp::group_description::name_max))
    in.problems().add(in.at("name"), "the name of a group has printable ASCII characters only");
  return out;
}

} // namespace

std::optional<smepp::key> secret_key::read(const node& x, const asker& who) const {
  const auto* found = x.as<std::string>();
  auto out = found == nullptr ? std::nullopt : smepp::key::from_hex(*found);
  if (!out)
    who.complain(x, '`' + std::string(who.key) + "` must be a key of 32 hexadecimal digits");
  else
    who.in.seen.secrets.push_back({name, x.at});
  return out;
}

/// `writeOnly` is how a schema says that a value is secret.
form secret_key::takes() {
  return {"key of 32 hexadecimal digits",
          with_member(pattern_schema("[0-9A-Fa-f]{32}"), "writeOnly", "true")};
}

smepp::group_settings read_smepp(table_reader& root, std::uint64_t seed) {
  smepp::group_settings out;
  root.table("smepp", "[smepp]", {"groups of motes, as SMEPP Light has them", "none"},
             [&](table_reader& in) {
               in.all(out, network_secret_keys());
               in.all(out.energy);
               in.all(out);
               in.all(out, sender_secret_keys());
               name_uniqueness names;
               in.tables(
                   "group", "[[smepp.group]]",
                   "groups that motes with the app `member` create and join",
                   [&](table_reader& x) { out.groups.push_back(read_group(x, seed, names)); });
             });
  const auto draw = [seed](std::optional<smepp::key>& x, const char* what) {
    if (!x)
      x = drawn_key(seed, what);
  };
  draw(out.network_key, "network_key");
  draw(out.network_mac, "network_mac");
  draw(out.pairwise_root, "pairwise_key");
  return out;
}

placed_app read_member(table_reader& in) {
  constexpr std::size_t wanted_max = 8; // event_config::subscriptions_max
  smepp::member_config app;
  placed_app out;
  in.all(app, member_group_keys());
  if (in.is_good("group") && !in.shared().names->groups.contains(app.group))
    in.problems().add(in.at("group"), "there is no [[smepp.group]] " + in_quotes(app.group));
  in.all(app);
  uniqueness<std::string> events;
  in.tables("subscribes", "subscriptions of a member",
            {"events that it subscribes to once it is a member", "none"}, [&](table_reader& x) {
              smepp::wanted_event wanted;
              x.all(wanted);
              if (!wanted.event.empty())
                events.add(wanted.event, "event `" + wanted.event + '`', x.at("event"),
                           x.problems(), "is already listed");
              if (x.sound() && wanted.until && *wanted.until <= wanted.from)
                x.problems().add(x.at("until"), "`until` must be later than `from`, which is " +
                                                    to_text(wanted.from));
              app.subscribes.push_back(std::move(wanted));
            });
  if (app.subscribes.size() > wanted_max)
    in.problems().add(in.at("subscribes"),
                      "`subscribes` must not have more than 8 events: a mote's table has no room");
  uniqueness<std::string> raised;
  in.tables("raises", "events of a member",
            {"events that it raises while a member subscribes to them", "none"},
            [&](table_reader& x) {
              smepp::raised_event event;
              x.all(event);
              if (!event.event.empty())
                raised.add(event.event, "event `" + event.event + '`', x.at("event"), x.problems(),
                           "is already listed");
              if (event.transducer)
                out.needs_at.push_back(x.at("transducer"));
              app.raises.push_back(std::move(event));
            });
  out.app = std::move(app);
  return out;
}

} // namespace rubicon::config
