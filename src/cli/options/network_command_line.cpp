#include "cli/options/network_command_line.hpp"

#include <charconv>
#include <cstdint>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include <CLI/CLI.hpp>

#include "cli/options/add_option.hpp"
#include "cli/options/option_values.hpp"
#include "cli/words/condition.hpp"
#include "peis/tuples/key.hpp"
#include "peis/wire/link_url.hpp"

namespace rubicon::cli {

namespace {

std::uint64_t parse_number(const char* name, const std::string& text, std::uint64_t max) {
  std::uint64_t x = 0;
  const auto end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, x);
  if (error != std::errc{} || stop != end || x < 1 || x > max)
    throw CLI::ValidationError(name, "not a number from 1 to " + std::to_string(max) + ": '" +
                                         text + '\'');
  return x;
}

peer_id parse_id(const char* name, const std::string& text) {
  return peer_id{static_cast<std::int32_t>(parse_number(name, text, peer_id_max))};
}

/// Digits are an id, all else a name.
peer_selector parse_selector(const char* name, const std::string& text) {
  constexpr std::size_t name_max = 63; // of a host record
  if (!text.empty() && text.find_first_not_of("0123456789") == std::string::npos)
    return {parse_id(name, text), {}};
  if (text.empty() || text.size() > name_max)
    throw CLI::ValidationError(name, "not an id or name of a peer: '" + text + '\'');
  return {std::nullopt, text};
}

std::string parse_peer(const std::string& text) {
  const auto whole = text.find("://") == std::string::npos ? "tcp://" + text : text;
  const auto url = peis::parse_link_url(whole);
  if (!url || url->medium != peis::link_url::scheme::tcp)
    throw CLI::ValidationError("--connect", "not HOST:PORT: '" + text + '\'');
  return peis::to_string(*url);
}

std::string parse_key(const char* name, const std::string& text, bool pattern) {
  const auto key = peis::key::parse(text);
  if (!key || (key->is_pattern() && !pattern))
    throw CLI::ValidationError(name, "not a key: '" + text +
                                         "' (up to 7 parts and 127 characters, as in lamp.state" +
                                         (pattern ? "; * stands for a part)" : ")"));
  return text;
}

void add_owner(CLI::App& app, peer_selector& owner) {
  add_parsed(app, "--owner", "PEER", "Only tuples of this peer, by its id or name",
             [&](const auto& text) { owner = parse_selector("--owner", text); });
}

void add_host(CLI::App& app, peer_selector& host) {
  add_parsed(app, "PEER", "", "Its id or name", [&](const auto& text) {
    host = parse_selector("PEER", text);
  })->required();
}

template <class What>
void add_key(CLI::App& app, What& x) {
  add_parsed(app, "KEY", "", "Name of the tuple", [&](const auto& text) {
    x.key = parse_key("KEY", text, false);
  })->required();
}

template <class What>
void add_its_owner(CLI::App& app, What& x) {
  add_parsed(app, "--owner", "PEER",
             "The owner of the tuple, by its id or name; default: the peer that has it",
             [&](const auto& text) { x.owner = parse_selector("--owner", text); });
}

void add_write(CLI::App& app, write_tuple& x) {
  add_key(app, x);
  app.add_option("VALUE", x.value,
                 "Text; @FILE: the octets of a file; - of standard input; @@ stands for @")
      ->required()
      ->type_name("");
  add_its_owner(app, x);
}

void add_meta(CLI::App& app, meta_tuple& x) {
  add_key(app, x);
  add_parsed(app, "TARGET", "", "Point it at this tuple",
             [&](const auto& text) { x.target = parse_key("TARGET", text, false); });
  add_its_owner(app, x);
  add_parsed(app, "--at", "PEER", "The owner of TARGET; default: that of --owner",
             [&](const auto& text) { x.target_owner = parse_selector("--at", text); });
  app.add_flag("--nowhere", x.nowhere, "Point it nowhere");
  app.final_callback([&x] {
    if (x.target && x.nowhere)
      throw CLI::ValidationError("--nowhere", "cannot be combined with TARGET");
    if (!x.target_owner.is_any() && !x.target)
      throw CLI::ValidationError("--at", "needs TARGET");
  });
}

} // namespace

template <class What>
What& network_command_line::add(CLI::App& below, const char* name, const char* text) {
  auto& app = *below.add_subcommand(name, text);
  const auto x = std::make_shared<What>();
  all_.push_back({&app, [this, x] { return network_command{with_, *x}; }});
  auto* const connect = add_parsed(app, "--connect", "HOST:PORT",
                                   "A peer of the network; default: one on this computer",
                                   [this](const auto& words) { with_.peer = parse_peer(words); });
  app.add_flag("--lan", with_.lan, "Also search the local network")->excludes(connect);
  add_parsed(app, "--network", "NAME",
             "The network's name; default: that of the peer found, else rubicon",
             [this](const auto& words) {
               if (words.size() > 62)
                 throw CLI::ValidationError("--network", "longer than 62 characters");
               with_.network = words;
               with_.network_given = true;
             });
  add_parsed(app, "--id", "ID", "Our own id; default: a random high one",
             [this](const auto& words) { with_.id = parse_id("--id", words); });
  add_parsed(app, "--timeout", "TIME", "How long to wait for answers; default: 5s",
             [this](const auto& words) { with_.timeout = parse_length(words, "--timeout"); });
  app.add_flag("--json", with_.json, "Print JSON");
  return *x;
}

network_command_line::network_command_line(CLI::App& app) {
  auto& tuples = *app.add_subcommand("tuples", "Read and write tuples of a running network");
  tuples.require_subcommand(1);
  const auto last = [this]() -> CLI::App& { return *all_.back().app; };

  auto& got = add<get_tuple>(tuples, "get", "Print the value of a tuple");
  add_parsed(last(), "KEY", "", "Name of the tuple", [&](const auto& text) {
    got.key = parse_key("KEY", text, false);
  })->required();
  add_owner(last(), got.owner);

  auto& awaited = add<wait_for_tuple>(tuples, "wait", "Wait until a tuple has a value");
  add_parsed(last(), "KEY", "", "Name of the tuple", [&](const auto& text) {
    awaited.key = parse_key("KEY", text, false);
  })->required();
  add_parsed(last(), "CONDITION", "",
             "on, '= on', '!= on', '> 20', '>= 20', '< 20' or '<= 20'; default: the tuple exists",
             [&](const auto& text) {
               awaited.until = parse_condition(text);
               if (!awaited.until)
                 throw CLI::ValidationError("CONDITION",
                                            "only a number is less or greater: '" + text + '\'');
             });
  add_owner(last(), awaited.owner);
  last().footer("--timeout says for how long. Exit status 1: not within that time.");

  auto& set = add<write_tuple>(tuples, "set", "Set a tuple at its owner");
  add_write(last(), set);
  last().add_flag("--wait", set.wait, "For a proxy's input: report the outcome of the actuation");
  auto& appended = add<write_tuple>(tuples, "append", "Append to a tuple at its owner");
  appended.append = true;
  add_write(last(), appended);
  auto& deleted = add<delete_tuple>(tuples, "delete", "Delete a tuple at its owner");
  add_key(last(), deleted);
  add_its_owner(last(), deleted);
  add_meta(last(), add<meta_tuple>(tuples, "meta", "Show or set where a meta tuple points"));

  auto& watched = add<watch_tuples>(tuples, "watch", "Print tuples as they change");
  last()
      .add_option("KEY", watched.patterns, "Names of tuples; * stands for a part")
      ->required()
      ->type_name("")
      ->check([](const std::string& text) {
        const auto key = peis::key::parse(text);
        return key ? std::string() : "not a key: '" + text + '\'';
      });
  add_owner(last(), watched.owner);
  add_parsed(last(), "--for", "TIME", "End after this time; default: at Ctrl-C",
             [&](const auto& text) { watched.length = parse_length(text, "--for"); });
  add_parsed(last(), "--count", "N", "End after this many changes",
             [&](const auto& text) { watched.count = parse_number("--count", text, UINT64_MAX); });

  auto& listed = add<list_tuples>(tuples, "ls", "List tuples");
  add_parsed(last(), "KEY", "", "Names of tuples; * stands for a part",
             [&](const auto& text) { listed.pattern = parse_key("KEY", text, true); });
  add_owner(last(), listed.owner);
  last().add_flag("--all", listed.all, "Also kernel.*, which describe the peers");

  auto& graph = add<show_graph>(tuples, "graph", "Show the owners and subscribers of tuples");
  last()
      .add_flag("--dot", graph.dot, "Print it for Graphviz's dot")
      ->excludes(last().get_option("--json"));
  last().add_flag("--all", graph.all, "Also kernel.*, which describe the peers");

  auto& top = add<show_top>(app, "top", "Watch a running network: peers, gateways, proxies");
  last().add_flag("--once", top.once, "Print once and end");
  add_parsed(last(), "--every", "TIME", "Interval of updates; default: 1s",
             [&](const auto& text) { top.every = parse_length(text, "--every"); });
  add_parsed(last(), "--count", "N", "End after this many updates",
             [&](const auto& text) { top.count = parse_number("--count", text, UINT64_MAX); });
  last().footer("On a terminal it fills the screen until q or Ctrl-C; into a pipe it writes one "
                "update after the other.");

  add<list_hosts>(app, "hosts", "List the peers of a running network");
  add_host(last(), add<trace_route>(app, "route", "Show the route to a peer and back").host);
  auto& pinged = add<ping_host>(app, "ping", "Measure the time to a peer and back");
  add_host(last(), pinged.host);
  add_parsed(last(), "--count", "N", "Number of pings; default: 4",
             [&](const auto& text) { pinged.count = parse_number("--count", text, UINT64_MAX); });
}

std::optional<network_command> network_command_line::parsed() const {
  for (const auto& x : all_) {
    if (x.app->parsed())
      return x.make();
  }
  return std::nullopt;
}

} // namespace rubicon::cli
