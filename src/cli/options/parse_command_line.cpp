#include "cli/options/parse_command_line.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/options/certs_command_line.hpp"
#include "cli/options/file_command_line.hpp"
#include "cli/options/help_command_line.hpp"
#include "cli/options/hosts_command_line.hpp"
#include "cli/options/network_command_line.hpp"
#include "cli/options/record_command_line.hpp"
#include "cli/options/run_command_line.hpp"
#include "cli/options/serial_command_line.hpp"
#include "cli/options/study_command_line.hpp"
#include "cli/words/describe.hpp"
#include "cli/words/refusal.hpp"
#include "cli/words/version.hpp"
#include "config/load.hpp"
#include "core/text/printable.hpp"

namespace rubicon::cli {

namespace {

constexpr const char* about =
    "Runs a robotic ecology: islands of wireless motes, their sinks, the gateways on basestation\n"
    "PCs, proxies, and PEIS peers, described by one TOML file.";

constexpr const char* roles =
    "Roles that the file can give this binary:\n"
    "  mote           a constrained node with a radio, transducers, actuators and programs\n"
    "  sink           the mote at the end of a basestation's serial cable\n"
    "  gateway        joins an island to the PEIS network, one per island\n"
    "  PEIS peer      a PC or robot with a PEIS kernel and its programs\n"
    "  proxy          represents one mote through tuples with meaning and units\n"
    "  proxy manager  starts and ends proxies as motes join and leave\n"
    "  init           starts, stops and watches the other components of its host\n"
    "\n"
    "Exit status: 0 success; 1 the run ended with violations, equal runs differed, no peer\n"
    "or host answered, or a certificate is invalid; 2 the command line or the file was rejected;\n"
    "130 Ctrl-C ended it.";

/// Help in which the names that an option needs or excludes stand in the order of the alphabet, not
/// of the addresses of their objects.
class ordered_help : public CLI::Formatter {
public:
  std::string make_option_opts(const CLI::Option* option) const override {
    std::istringstream words(CLI::Formatter::make_option_opts(option));
    const std::set<std::string> labels{get_label("Needs") + ':', get_label("Excludes") + ':'};
    std::string out;
    const auto by_letters = [](const std::string& a, const std::string& b) {
      return a.substr(std::min(a.find_first_not_of('-'), a.size())) <
             b.substr(std::min(b.find_first_not_of('-'), b.size()));
    };
    std::set<std::string, decltype(by_letters)> names;
    bool is_list = false;
    const auto end_list = [&] {
      for (const auto& name : names)
        out += ' ' + name;
      names.clear();
    };
    for (std::string word; words >> word;) {
      if (const bool is_label = labels.contains(word); is_label || !is_list) {
        end_list();
        out += ' ' + word;
        is_list = is_list || is_label;
      } else {
        names.insert(word);
      }
    }
    end_list();
    return out;
  }
};

/// The command line without its commands.
class ordered_app : public CLI::App {
public:
  ordered_app() : CLI::App(about, "rubicon") { formatter(std::make_shared<ordered_help>()); }
};

/// All commands, each with its options.
class all_commands {
public:
  all_commands() {
    app.set_version_flag("--version", std::string("rubicon ") + version);
    app.require_subcommand(1);
    app.footer(roles); // last: subcommands would inherit it
  }
  all_commands(const all_commands&) = delete;
  all_commands& operator=(const all_commands&) = delete;

  /// After parsing.
  [[nodiscard]] command parsed(const original_options& original) const {
    if (auto x = run_.parsed(original))
      return *std::move(x);
    if (auto x = network_.parsed()) {
      x->with.without_effect = original.without_effect;
      return *std::move(x);
    }
    if (auto x = certs_.parsed())
      return *std::move(x);
    if (auto x = serial_.parsed())
      return *std::move(x);
    for (auto&& x :
         {file_.parsed(), hosts_.parsed(), study_.parsed(), record_.parsed(), help_.parsed()})
      if (x)
        return *x;
    return refused_command{"rubicon: no command\n"};
  }

  ordered_app app;

private:
  run_command_line run_{app};
  file_command_line file_{app};
  hosts_command_line hosts_{app};
  study_command_line study_{app};
  record_command_line record_{app};
  certs_command_line certs_{app};
  serial_command_line serial_{app};
  network_command_line network_{app};
  help_command_line help_{app};
};

/// `help run` as `run --help`, and no word at all as `--help`.
void take_help(std::vector<std::string>& words) {
  if (words.size() == 1)
    words.emplace_back("--help");
  if (words.size() > 1 && words[1] == "help" && words.back() != "--help" &&
      !(words.size() > 2 && words[2].starts_with("--pages"))) {
    words.erase(words.begin() + 1);
    words.emplace_back("--help");
  }
}

constexpr std::size_t options_octets_max = 65'536;

/// Commands that join a network have options of their own for the original ones.
std::vector<std::string> options_of_member(const original_options& x) {
  std::vector<std::string> words;
  if (!x.connect.empty())
    words.insert(words.end(),
                 {"--connect", x.connect.front().substr(x.connect.front().find("://") + 3)});
  if (x.network)
    words.insert(words.end(), {"--network", *x.network});
  if (x.id)
    words.insert(words.end(), {"--id", std::to_string(x.id->value)});
  return words;
}

command parse_words(std::span<const char* const> arguments, const original_options& original) {
  all_commands all;
  auto& app = all.app;
  app.failure_message([&](const CLI::App*, const CLI::Error& error) {
    const auto unknown = unknown_word(app, arguments);
    return refusal(app, arguments, unknown.empty() ? error.what() : unknown);
  });
  try {
    app.parse(static_cast<int>(arguments.size()), arguments.data());
  } catch (const CLI::ParseError& error) {
    const auto unknown = unknown_word(app, arguments);
    if (error.get_exit_code() == 0 && !unknown.empty()) // `help` of what is not there
      return refused_command{refusal(app, arguments, unknown)};
    std::ostringstream out;
    std::ostringstream err;
    if (app.exit(error, out, err) == 0)
      return show_command{out.str()};
    return refused_command{err.str()};
  }
  return all.parsed(original);
}

} // namespace

command parse_command_line(std::span<const char* const> arguments) {
  std::vector<std::string> words(arguments.begin(), arguments.end());
  const auto taken = take_original_options(
      words, [](const auto& file) { return config::read_file(file, options_octets_max).text; });
  if (const auto* why = std::get_if<std::string>(&taken))
    return refused_command{printable(*why) + '\n'};
  const auto& original = std::get<original_options>(taken);
  take_help(words);
  const auto name = words.size() > 1 ? words[1] : std::string();
  constexpr std::string_view members[] = {"top", "hosts", "tuples", "route", "ping"};
  if (std::ranges::find(members, name) != std::end(members))
    std::ranges::move(options_of_member(original), std::back_inserter(words));
  else if (!original.said.empty() && name != "run")
    return refused_command{
        "options of --peis- are for `run` and for commands that join a network\n"};
  std::vector<const char*> rest;
  for (const auto& word : words)
    rest.push_back(word.c_str());
  return parse_words(rest, original);
}

command_description describe_commands() {
  const all_commands all;
  return describe(all.app);
}

} // namespace rubicon::cli
