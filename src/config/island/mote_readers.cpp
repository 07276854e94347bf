#include "config/island/mote_readers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "config/island/application_readers.hpp"
#include "config/island/mote_keys.hpp"
#include "config/island/size_check.hpp"
#include "radio/mac_rules.hpp"
#include "radio/parameter_keys.hpp"

namespace rubicon::config {

namespace {

/// Whether `a` takes the place of `b`: same kind, same channel or AM type. Messengers and senders
/// never do.
struct takes_place_of {
  bool operator()(const sampler_app& a, const sampler_app& b) const {
    return a.channel == b.channel;
  }
  bool operator()(const actuator_app& a, const actuator_app& b) const {
    return a.channel == b.channel;
  }
  bool operator()(const listener_app& a, const listener_app& b) const {
    return a.am_type == b.am_type;
  }
  bool operator()(const member_app& a, const member_app& b) const { return a.group == b.group; }
  bool operator()(const tinyos::program_config& a, const tinyos::program_config& b) const {
    return a.kind == b.kind;
  }
  bool operator()(const firmware::program_config&, const firmware::program_config&) const {
    return true;
  }
  bool operator()(const traffic::relay_config&, const traffic::relay_config&) const { return true; }
  bool operator()(const traffic::receiver_config&, const traffic::receiver_config&) const {
    return true;
  }
  template <class A, class B>
  bool operator()(const A&, const B&) const {
    return false;
  }
};

void merge(std::vector<placed_app>& into, std::vector<placed_app> added) {
  std::erase_if(into, [&added](const placed_app& old) {
    return std::any_of(added.begin(), added.end(), [&old](const placed_app& x) {
      return std::visit(takes_place_of{}, x.app, old.app);
    });
  });
  std::move(added.begin(), added.end(), std::back_inserter(into));
}

std::string listing(const std::vector<std::string>& names) {
  std::string text = names.empty() ? "none" : "";
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : ", ") + names[i];
  return text;
}

/// Checks one app against what else is on its mote.
struct app_check {
  const mote_profile& on;
  const placed_app& app;
  uniqueness<std::uint16_t>& inputs;  ///< channels and AM types received
  uniqueness<std::uint16_t>& outputs; ///< channels sent
  uniqueness<std::string>& singles;   ///< what a mote has once
  reading& shared;
  complaints& problems = shared.problems;

  void operator()(const sampler_app& x) const {
    check_transducers(x.transducers);
    add(outputs, "output", x.channel);
  }

  void operator()(const apps::app_config& x) const { check_transducers(needs(x)); }

  void operator()(const separate_app& x) const { check_transducers(needs(x.program)); }

  void operator()(const actuator_app& x) const {
    std::vector<std::string> present;
    for (const auto& each : on.like.actuators)
      present.push_back(each.name);
    if (!x.actuator.empty() &&
        std::find(present.begin(), present.end(), x.actuator) == present.end())
      problems.add(app.needs_at[0],
                   "the mote has no actuator `" + x.actuator + "`; it has: " + listing(present));
    add(outputs, "output", x.channel);
    add(inputs, "input", x.channel);
  }

  void operator()(const messenger_app&) const {}

  void operator()(const listener_app& x) const { add(inputs, "input", x.am_type); }

  void operator()(const member_app& x) const {
    std::vector<device::quantity> wanted;
    for (const auto& each : x.raises)
      if (each.transducer)
        wanted.push_back(*each.transducer);
    check_transducers(wanted);
    claim_single("member of group " + x.group);
  }

  void operator()(const tinyos::program_config& x) const {
    if (x.transducer)
      check_transducers({*x.transducer});
    claim_single(std::string(to_string(x.kind)));
  }

  void operator()(const firmware::program_config&) const {
    if (!std::ranges::all_of(
            on.apps, [](const placed_app& x) { return is_flow_app(x.app) || is_firmware(x.app); }))
      problems.add(app.channel_at, "a mote with `firmware` has no other apps than sender, relay "
                                   "and receiver: it is its firmware that runs on it");
  }

  void operator()(const traffic::sender_config&) const {}

  void operator()(const traffic::relay_config&) const { claim_single("relay"); }

  void operator()(const traffic::receiver_config&) const { claim_single("receiver"); }

private:
  void check_transducers(const std::vector<device::quantity>& wanted) const {
    std::vector<std::string> present;
    for (const auto& each : on.like.transducers)
      present.push_back(shared.quantities.word_of(each.kind));
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const auto& name = shared.quantities.word_of(wanted[i]);
      if (wanted[i] != device::quantity::signal && // which is of its radio
          std::find(present.begin(), present.end(), name) == present.end())
        problems.add(app.needs_at[i],
                     "the mote has no transducer `" + name + "`; it has: " + listing(present));
    }
  }

  void add(uniqueness<std::uint16_t>& among, std::string_view kind, std::uint16_t channel) const {
    among.add(channel, std::string(kind) + " channel " + std::to_string(channel) + " of the mote",
              app.channel_at, problems);
  }

  void claim_single(const std::string& kind) const {
    singles.add(kind, "the " + kind + " of the mote", app.channel_at, problems);
  }
};

/// A dead band in counts: at least one.
std::vector<std::int32_t> band_counts(const std::vector<device::transducer_config>& transducers,
                                      const sampler_app& sampler,
                                      const std::vector<std::optional<double>>& bands) {
  constexpr double most = 65536; // more than two counts can differ
  std::vector<std::int32_t> out;
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const auto of =
        std::ranges::find(transducers, sampler.transducers[i], &device::transducer_config::kind);
    const auto resolution = of == transducers.end() ? 1 : of->resolution; // 1 of the signal
    const auto counts = std::clamp(std::round(bands[i].value_or(0) / resolution), 1.0, most);
    out.push_back(bands[i] ? static_cast<std::int32_t>(counts) : 0);
  }
  return out;
}

/// Sets the ends of an app.
struct end_setter {
  const std::vector<std::optional<mote_id>>& ends;

  void operator()(traffic::sender_config& x) const {
    x.to = ends.at(0).value_or(mote_id{});
    x.via = ends.at(1);
  }
  void operator()(traffic::relay_config& x) const { x.next = ends.at(0).value_or(mote_id{}); }
  template <class App>
  void operator()(App&) const {}
};

} // namespace

mote_description mote_profile::mote() const {
  auto out = like;
  for (const auto& each : apps) {
    auto& all = out.apps.edit();
    all.push_back(each.app);
    if (auto* sampler = std::get_if<sampler_app>(&all.back()))
      sampler->dead_band = band_counts(like.transducers, *sampler, each.dead_band);
  }
  return out;
}

void read_profile(table_reader& in, mote_profile& out) {
  in.all(out.like, profile_keys());
  if (in.is_good("power"))
    out.transmit_at = in.at("power");
  read_access(in, out.like.access, out.access_at);
  read_transducers(in, out.like.transducers.edit());
  read_actuators(in, out.like.actuators.edit());
  merge(out.apps, read_mote_apps(in));
  merge(out.apps, read_firmware(in));
}

void check_profile(const mote_profile& x, reading& shared) {
  uniqueness<std::uint16_t> inputs;
  uniqueness<std::uint16_t> outputs;
  uniqueness<std::string> singles;
  for (const auto& app : x.apps)
    std::visit(app_check{x, app, inputs, outputs, singles, shared}, app.app);
  constexpr std::ptrdiff_t groups_max = 4; // smepp::group_config::groups_max
  const auto is_member = [](const placed_app& app) {
    return std::holds_alternative<member_app>(app.app);
  };
  if (std::ranges::count_if(x.apps, is_member) > groups_max)
    shared.problems.add(std::ranges::find_if(x.apps, is_member)->channel_at,
                        "a mote may be a member of 4 groups at most");
  end_uniqueness ends;
  for (const auto& app : x.apps) {
    for (const auto& program : programs_of({app}))
      ends.add(program, app.channel_at, shared.problems);
  }
  check_power(*x.like.platform, x.like.transmit_dbm, x.transmit_at, shared.problems);
  check_access(x.like.access, x.access_at, shared.problems);
}

void read_access(table_reader& in, radio::access_parameters& out, mark& at) {
  in.table("csma", "csma",
           {"parameters of its medium access; each absent one is its type's, or that of the medium "
            "access",
            "those of the medium access"},
           [&](table_reader& x) {
             x.all(out);
             at = x.at(x.has("min_be") ? "min_be" : "max_be");
           });
}

void check_access(const radio::access_parameters& x, mark at, complaints& problems) {
  using namespace radio::timing;
  if (const auto max = x.max_be.value_or(be_max); x.min_be.value_or(be_min) > max)
    problems.add(at, "`min_be` must not be above `max_be`, which is " + std::to_string(max));
}

void check_rules(const radio::channel_config& radio, const radio::platform& platform,
                 const radio::access_parameters& x, mark at, complaints& problems) {
  const auto named =
      std::ranges::find(radio.macs, platform.name, &std::pair<std::string, std::string>::first);
  if (named == radio.macs.end() || !(x.min_be || x.max_be || x.backoffs_max))
    return;
  const auto* rules = radio::find_mac(named->second, platform);
  if (rules != nullptr && !radio::has_exponents(*rules))
    problems.add(at, "with the medium access \"" + named->second + "\" of a " +
                         std::string(platform.name) +
                         " `min_be`, `max_be` and `backoffs` have no effect: only `retries` does");
}

void check_power(const radio::platform& platform, const std::optional<double>& dbm, mark at,
                 complaints& problems) {
  const auto least = platform.transmit.front().dbm;
  const auto most = platform.transmit_dbm_max();
  if (dbm && (*dbm < least || *dbm > most))
    problems.add(at, "`power` of a " + std::string(platform.name) + " must be from " +
                         shown(least) + " to " + shown(most) + " dBm, not " + shown(*dbm));
}

void settle_flows(std::vector<placed_app>& apps, island_id island, mote_id sink,
                  complaints& problems) {
  for (auto& app : apps) {
    std::vector<std::optional<mote_id>> ends;
    for (const auto& each : app.ends) {
      ends.emplace_back();
      if (!each.value)
        continue;
      if (each.value->island && *each.value->island != island)
        problems.add(each.at, "packets of measuring apps do not leave their island");
      else
        ends.back() = each.value->mote.value_or(sink);
    }
    if (!ends.empty())
      std::visit(end_setter{ends}, app.app);
  }
}

bool uses_radio_alone(const mote_app& x) {
  return is_flow_app(x) || is_firmware(x) || std::holds_alternative<member_app>(x);
}

bool is_firmware(const mote_app& x) {
  return std::holds_alternative<firmware::program_config>(x);
}

bool is_plain_app(const mote_app& x) {
  return std::holds_alternative<tinyos::program_config>(x);
}

bool is_flow_app(const mote_app& x) {
  return std::holds_alternative<traffic::sender_config>(x) ||
         std::holds_alternative<traffic::relay_config>(x) ||
         std::holds_alternative<traffic::receiver_config>(x);
}

mote_types read_mote_types(table_reader& root) {
  mote_types out;
  root.named_tables("mote_type", "[mote_type.NAME]", "kinds of mote",
                    [&](const located<std::string>& name, table_reader& in) {
                      if (!is_name(name.value))
                        in.problems().add(
                            name.at, "mote type " + in_quotes(name.value) +
                                         " must have a name of 1 to 32 letters, digits, - and _");
                      mote_profile profile;
                      in.all(profile.like, mote_type_keys());
                      read_profile(in, profile);
                      profile.like.type_name = name.value;
                      out.emplace(name.value, std::move(profile));
                    });
  return out;
}

} // namespace rubicon::config
