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

smepp::group_description read_group(table_reader& in, std::uint64_t seed, name_claims& names) {
  smepp::group_description out;
  if (in.required("name", text{smepp::group_description::name_max}, out.name,
                  "name that `group` of the app `member` refers to"))
    names.claim(out.name, "group", in.at("name"), in.problems());
  in.optional("closed", flag{}, out.is_closed, "only motes with the master key may enter");
  in.optional("private", flag{}, out.is_private, "only motes with the master key may find it");
  std::optional<smepp::key> master;
  in.optional("master_key", secret_key{master_key_name(out.name)}, master,
              {"key to enter a closed group and to find a private one; the motes with a `member` "
               "of the group have it",
               "drawn from the seed, which is not secret"});
  if (in.has("master_key") && in.sound() && !out.is_closed && !out.is_private)
    in.problems().add(in.at("master_key"),
                      "`master_key` has no effect on a group that is neither closed nor private");
  if (out.is_closed || out.is_private)
    out.master = master ? master : drawn_key(seed, "group/" + out.name);
  in.optional("period", time_span{0s, period_max}, out.management.period,
              "period of management windows, in which radios of members are on for control "
              "messages; 0: always");
  in.optional("window", time_span{60ms, period_max}, out.management.length,
              "length of such a window");
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
  enum class authenticated : std::uint8_t { group, sender };
  smepp::group_settings out;
  root.table(
      "smepp", "[smepp]", {"groups of motes, as SMEPP Light has them", "none"},
      [&](table_reader& in) {
        in.optional("network_key", secret_key{"smepp.network_key"}, out.network_key,
                    {"encrypts all frames", "drawn from the seed, which is not secret"});
        in.optional("network_mac", secret_key{"smepp.network_mac"}, out.network_mac,
                    {"authenticates them", "drawn from the seed, which is not secret"});
        in.all(out.energy);
        in.all(out);
        auto proven = authenticated::group;
        in.optional("authenticate",
                    word<authenticated>{
                        {{"group", authenticated::group}, {"sender", authenticated::sender}}},
                    proven,
                    "proof that an event carries: that a member has raised it, or which one, by a "
                    "key that it shares with the subscriber");
        out.authenticates_sender = proven == authenticated::sender;
        in.optional("pairwise_key", secret_key{"smepp.pairwise_key"}, out.pairwise_root,
                    {"secret from which pairwise keys of motes are derived; no mote has it",
                     "drawn from the seed, which is not secret"});
        name_claims names;
        in.tables("group", "[[smepp.group]]",
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
  const bool has_group =
      in.required("group", text{smepp::group_description::name_max}, app.group, "its name");
  if (has_group && !in.names().groups.contains(app.group))
    in.problems().add(in.at("group"), "there is no [[smepp.group]] " + in_quotes(app.group));
  in.all(app);
  claims<std::string> events;
  in.tables("subscribes", "subscriptions of a member",
            {"events that it subscribes to once it is a member", "none"}, [&](table_reader& x) {
              smepp::wanted_event wanted;
              x.all(wanted);
              if (!wanted.event.empty())
                events.claim(wanted.event, "event `" + wanted.event + '`', x.at("event"),
                             x.problems(), "is already listed");
              if (x.sound() && wanted.until && *wanted.until <= wanted.from)
                x.problems().add(x.at("until"), "`until` must be later than `from`, which is " +
                                                    to_text(wanted.from));
              app.subscribes.push_back(std::move(wanted));
            });
  if (app.subscribes.size() > wanted_max)
    in.problems().add(in.at("subscribes"),
                      "`subscribes` must not have more than 8 events: a mote's table has no room");
  claims<std::string> raised;
  in.tables("raises", "events of a member",
            {"events that it raises while a member subscribes to them", "none"},
            [&](table_reader& x) {
              smepp::raised_event event;
              x.all(event);
              if (!event.event.empty())
                raised.claim(event.event, "event `" + event.event + '`', x.at("event"),
                             x.problems(), "is already listed");
              if (event.transducer)
                out.needs_at.push_back(x.at("transducer"));
              app.raises.push_back(std::move(event));
            });
  out.app = std::move(app);
  return out;
}

} // namespace rubicon::config
