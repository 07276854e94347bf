#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "cli/network/network_text.hpp"
#include "cli/network/session.hpp"
#include "cli/print/console.hpp"
#include "cli/print/local_time.hpp"
#include "config/load.hpp"
#include "core/text/printable.hpp"
#include "io/process/signal_watch.hpp"
#include "peis/tuples/meta_tuple.hpp"
#include "report/figures.hpp"
#include "report/history.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

namespace {

constexpr std::size_t file_octets_max = 16U * 1024 * 1024; // of a file, as messages have

using found_tuples = std::vector<peis::tuple_pointer>;

std::string refused(peis::cause why) {
  return "refused: " + std::string(peis::to_string(why));
}

/// What others hold under a pattern now; ours describe only this command.
found_tuples held(const session& at, peer_id owner, const std::string& pattern) {
  auto all = at.peer().kernel().reader().find_all(owner, pattern);
  std::erase_if(all, [&](const auto& x) { return x->owner == at.peer().kernel().id(); });
  return all;
}

/// Subscribes, and waits until what is there has come.
found_tuples gather(const session& at, std::optional<peer_id> owner, const std::string& pattern) {
  const auto whose = owner.value_or(any_peer);
  std::size_t news = 0;
  const scoped_subscription watch(at, whose, pattern, [&](const auto&) { ++news; });
  if (watch.refused() != nullptr)
    return {};
  static_cast<void>(
      at.self.await_quiet([&] { return !held(at, whose, pattern).empty(); },
                          [&] { return news + at.peer().network().hosts.records().size(); }));
  return held(at, whose, pattern);
}

std::string as_json(const found_tuples& all) {
  std::vector<nlohmann::ordered_json> rows;
  for (const auto& x : all)
    rows.push_back(to_json(*x));
  return lines_of(rows);
}

std::string as_table(const found_tuples& all) {
  report::table table(
      {{"owner", report::align::right}, {"key"}, {"size", report::align::point}, {"value"}});
  for (const auto& x : all)
    table.add({to_string(x->owner), report::printable(x->name.text()),
               report::octet_size(x->value.size()), value_text(*x)});
  const auto output = console_of(stdout);
  return table.render(output.room(), output.colour);
}

/// How a request at another peer has ended; good: it has acknowledged.
exit_status status_of(peer_id owner, std::optional<peis::cause> ended) {
  if (!ended)
    return fail("peer " + to_string(owner) + " did not acknowledge it");
  if (*ended != peis::cause::none)
    return fail(refused(*ended));
  return exit_status::good;
}

exit_status acknowledged(const session& at, peer_id owner, const std::string& key,
                         std::optional<peis::cause> ended) {
  const auto status = status_of(owner, ended);
  if (status != exit_status::good || !at.with.json)
    return status;
  return answer(line_of({{"owner", owner.value}, {"key", key}, {"acknowledged", true}}));
}

/// Waits for a tuple of a peer that is there.
peis::reading fetch(const session& at, peer_id owner, const std::string& key) {
  static_cast<void>(at.peer().tuples().subscribe(owner, key));
  return at.peer().tuples().get(owner, key, peis::read_mode::keep_old, at.with.timeout);
}

exit_status show_meta(const session& at, peer_id owner, const meta_tuple& x) {
  const auto found = fetch(at, owner, x.key);
  if (!found)
    return fail("peer " + to_string(owner) + " has no tuple `" + x.key + '`');
  const auto reference = peis::read_meta(*found.content);
  if (!reference)
    return fail("tuple `" + x.key + "` of peer " + to_string(owner) + " is not a meta tuple");
  nlohmann::ordered_json out{{"owner", owner.value}, {"key", x.key}, {"target", nullptr}};
  if (!*reference)
    return answer(at.with.json ? line_of(out) : "nowhere\n");
  const auto& target = **reference;
  const auto key = target.name.text();
  out["target"] = {{"owner", target.owner.value}, {"key", printable(key)}};
  const auto there = fetch(at, target.owner, std::string(key));
  if (there)
    out["target"] = to_json(*there.content);
  return answer(at.with.json ? line_of(out)
                             : to_string(target.owner) + ' ' + printable(key) + "  " +
                                   (there ? value_text(*there.content) : "(no such tuple)") + '\n');
}

/// Prints changes; columns grow with what has been seen.
class change_printer {
public:
  explicit change_printer(bool json) : json_(json) {}

  [[nodiscard]] bool operator()(const peis::tuple& x, bool deleted) {
    ++count_;
    return print(stdout, json_ ? as_line(x, deleted) : as_row(x, deleted));
  }

  [[nodiscard]] std::uint64_t count() const { return count_; }

private:
  [[nodiscard]] static std::string as_line(const peis::tuple& x, bool deleted) {
    auto out = to_json(x);
    if (deleted)
      out["deleted"] = true;
    return line_of(out);
  }

  [[nodiscard]] std::string as_row(const peis::tuple& x, bool deleted) {
    const auto padded = [](std::string text, std::size_t& width, bool left) {
      const auto used = report::display_width(text);
      width = std::max(width, used);
      const std::string blanks(width - used, ' ');
      return left ? text + blanks : blanks + text;
    };
    return clock_now(true) + "  " + padded(to_string(x.owner), owner_width_, false) + "  " +
           padded(report::printable(x.name.text()), key_width_, true) + "  " +
           (deleted ? "(deleted)" : value_text(x)) + '\n';
  }

  bool json_;
  std::size_t owner_width_ = 5;
  std::size_t key_width_ = 20;
  std::uint64_t count_ = 0;
};

} // namespace

exit_status perform(const session& at, const get_tuple& x) {
  if (x.owner.is_any()) {
    const auto all = gather(at, std::nullopt, x.key);
    if (all.empty())
      return fail("no peer has a tuple `" + x.key + '`');
    if (at.with.json)
      return answer(as_json(all));
    return answer(all.size() == 1 ? value_text(*all.front()) + '\n' : as_table(all));
  }
  const auto owner = find_peer(at, x.owner);
  if (const auto* why = std::get_if<std::string>(&owner))
    return fail(*why);
  const auto id = std::get<peer_id>(owner);
  const auto watch = at.peer().tuples().subscribe(id, x.key);
  if (const auto* why = std::get_if<peis::cause>(&watch))
    return fail(refused(*why));
  const auto found = at.peer().tuples().get(id, x.key, peis::read_mode::keep_old, at.with.timeout);
  if (!found)
    return fail("peer " + to_string(id) + " has no tuple `" + x.key + '`');
  return answer(at.with.json ? line_of(to_json(*found.content))
                             : value_text(*found.content) + '\n');
}

namespace {

/// Of what a proxy has said, `on acknowledged`, the second part; nothing if it is about another
/// word.
std::optional<std::string> outcome_of(const peis::tuple& x, const std::string& word) {
  const auto text = x.text();
  const auto blank = text.rfind(' ');
  if (blank == std::string_view::npos || text.substr(0, blank) != word)
    return std::nullopt;
  return std::string(text.substr(blank + 1));
}

/// Sets an input of a proxy (docs/gateway.md) and waits for its outcome.
exit_status set_and_wait(const session& at, peer_id owner, const write_tuple& x,
                         const std::string& value) {
  bool is_written = false; // earlier notifications are about something else
  std::optional<std::string> outcome;
  const scoped_subscription watch(at, owner, x.key + ".outcome", [&](const auto& changed) {
    if (is_written && !outcome)
      outcome = outcome_of(*changed, value);
  });
  if (const auto* why = watch.refused())
    return fail(refused(*why));
  const auto deadline = fetch(at, owner, x.key + ".deadline");
  const auto longest_s = deadline ? report::number_of(deadline.content->text()) : std::nullopt;
  if (!longest_s)
    return fail("peer " + to_string(owner) + " has no tuple `" + x.key +
                ".deadline`: no proxy reports the outcome");
  is_written = true;
  const auto ended = at.peer().await(at.with.timeout, [&](auto then) {
    at.peer().tuples().set_remote(owner, x.key, peis::text_content(value), std::move(then));
  });
  if (const auto status = status_of(owner, ended); status != exit_status::good)
    return status;
  const auto longest =
      duration(static_cast<std::int64_t>(std::clamp(*longest_s, 0.0, 86'400.0) * 1e9));
  at.peer().run_until([&outcome] { return outcome.has_value(); }, longest + at.with.timeout);
  if (!outcome)
    return fail("the proxy has not reported an outcome within " +
                to_text(longest + at.with.timeout));
  const auto shown = at.with.json
                         ? line_of({{"owner", owner.value}, {"key", x.key}, {"outcome", *outcome}})
                         : printable(*outcome) + '\n';
  const auto status = answer(shown);
  const bool is_good = *outcome == "acknowledged" || *outcome == "sent"; // more is never known
  return status == exit_status::good && !is_good ? exit_status::failed : status;
}

} // namespace

namespace {

/// What a value on the command line stands for (write_tuple::value).
struct given_value {
  std::string octets;
  bool is_text = true; ///< not of a file
};

/// @returns it, or why it cannot be read
std::variant<given_value, std::string> value_of(const std::string& word) {
  if (!word.starts_with('@') && word != "-")
    return given_value{word};
  if (word.starts_with("@@"))
    return given_value{word.substr(1)};
  const bool is_file = word != "-";
  auto read = is_file ? config::read_file(word.substr(1), file_octets_max)
                      : config::read_stream(*stdin, file_octets_max);
  if (!read.text)
    return (is_file ? word.substr(1) : "standard input") + ' ' + read.reason;
  return given_value{std::move(*read.text), false};
}

} // namespace

exit_status perform(const session& at, const write_tuple& x) {
  const auto given = value_of(x.value);
  if (const auto* why = std::get_if<std::string>(&given))
    return fail(*why);
  const auto& value = std::get<given_value>(given);
  std::vector<std::string> keys{x.key};
  if (const auto deadline = x.key + ".deadline"; peis::key::parse(deadline) && !x.append)
    keys.push_back(deadline); // an input of a proxy that nobody has written yet
  const auto found = find_owner(at, x.owner, keys);
  if (const auto* why = std::get_if<std::string>(&found))
    return fail(*why);
  const auto owner = std::get<peer_id>(found);
  if (x.wait)
    return set_and_wait(at, owner, x, value.octets);
  const auto ended = at.peer().await(at.with.timeout, [&](auto then) {
    if (x.append)
      at.peer().tuples().append(peis::prototype_of(owner, *peis::key::parse(x.key)),
                                to_bytes(value.octets), std::move(then));
    else
      at.peer().tuples().set_remote(owner, x.key,
                                    value.is_text ? peis::text_content(value.octets)
                                                  : peis::binary_content(to_bytes(value.octets)),
                                    std::move(then));
  });
  return acknowledged(at, owner, x.key, ended);
}

exit_status perform(const session& at, const delete_tuple& x) {
  const auto found = find_owner(at, x.owner, {x.key});
  if (const auto* why = std::get_if<std::string>(&found))
    return fail(*why);
  const auto owner = std::get<peer_id>(found);
  const auto ended = at.peer().await(at.with.timeout, [&](auto then) {
    at.peer().tuples().remove_remote(owner, x.key, std::move(then));
  });
  return acknowledged(at, owner, x.key, ended);
}

exit_status perform(const session& at, const meta_tuple& x) {
  const auto found = find_owner(at, x.owner, {x.key});
  if (const auto* why = std::get_if<std::string>(&found))
    return fail(*why);
  const auto owner = std::get<peer_id>(found);
  if (!x.target && !x.nowhere)
    return show_meta(at, owner, x);
  peis::meta_reference reference;
  if (x.target) {
    auto whose = owner;
    if (x.target_owner.id)
      whose = *x.target_owner.id; // which may come later
    else if (!x.target_owner.is_any()) {
      const auto named = find_peer(at, x.target_owner);
      if (const auto* why = std::get_if<std::string>(&named))
        return fail(*why);
      whose = std::get<peer_id>(named);
    }
    reference = peis::meta_target{whose, *peis::key::parse(*x.target)};
  }
  const auto ended = at.peer().await(at.with.timeout, [&](auto then) {
    at.peer().tuples().set_remote(owner, x.key, peis::meta_content(reference), std::move(then));
  });
  return acknowledged(at, owner, x.key, ended);
}

exit_status perform(const session& at, const list_tuples& x) {
  std::optional<peer_id> owner;
  if (!x.owner.is_any()) {
    const auto found = find_peer(at, x.owner);
    if (const auto* why = std::get_if<std::string>(&found))
      return fail(*why);
    owner = std::get<peer_id>(found);
  }
  auto all = gather(at, owner, x.pattern);
  if (x.pattern.empty() && !x.all)
    std::erase_if(all, [](const auto& y) { return is_of_kernel(*y); });
  if (all.empty())
    return fail(x.pattern.empty() ? "no tuples" : "no peer has a tuple `" + x.pattern + '`');
  return answer(at.with.json ? as_json(all) : as_table(all));
}

namespace {

bool is_cut_off(const session& at) {
  return at.peer().links().open_links() == 0;
}

exit_status fail_without_link(const session& at) {
  return fail("the link to " + at.with.peer + " is gone");
}

/// Whose tuples are looked at, or why that is not known. A peer by its id may come later.
std::variant<peer_id, std::string> watched_owner(const session& at, const peer_selector& x) {
  if (x.is_any())
    return any_peer;
  return x.id ? std::variant<peer_id, std::string>(*x.id) : find_peer(at, x);
}

} // namespace

exit_status perform(const session& at, const wait_for_tuple& x) {
  const auto owner = watched_owner(at, x.owner);
  if (const auto* why = std::get_if<std::string>(&owner))
    return fail(*why);
  peis::tuple_pointer last;
  bool holds = false;
  const scoped_subscription watch(at, std::get<peer_id>(owner), x.key, [&](const auto& changed) {
    if (holds || changed->owner == at.peer().kernel().id())
      return;
    last = changed;
    holds = !x.until || x.until->holds(value_text(*changed));
  });
  if (const auto* why = watch.refused())
    return fail(refused(*why));
  at.peer().run_until([&] { return holds || is_cut_off(at); }, at.with.timeout);
  if (holds)
    return answer(at.with.json ? line_of(to_json(*last)) : value_text(*last) + '\n');
  if (is_cut_off(at))
    return fail_without_link(at);
  return fail(
      "not within " + to_text(at.with.timeout) + ": " +
      (last ? "tuple `" + x.key + "` of peer " + to_string(last->owner) + " is " + value_text(*last)
            : "no peer has a tuple `" + x.key + '`'));
}

exit_status perform(const session& at, const watch_tuples& x) {
  const auto owner = watched_owner(at, x.owner);
  if (const auto* why = std::get_if<std::string>(&owner))
    return fail(*why);
  const auto whose = std::get<peer_id>(owner);
  change_printer printer(at.with.json);
  bool written = true;
  bool over = false;
  const auto on_change = [&](const peis::tuple& y, bool deleted) {
    if (over || y.owner == at.peer().kernel().id())
      return;
    written = printer(y, deleted) && written;
    over = !written || printer.count() == x.count;
  };
  std::deque<scoped_subscription> watches;
  for (const auto& pattern : x.patterns) {
    const auto& watch = watches.emplace_back(
        at, whose, pattern, [&](const auto& y) { on_change(*y, false); },
        [&](const auto& y) { on_change(*y, true); });
    if (const auto* why = watch.refused())
      return fail(refused(*why));
  }
  bool interrupted = false;
  const io::signal_watch signals(at.loop, [&](int) { over = interrupted = true; });
  const auto end = at.peer().now() + x.length.value_or(0s);
  while (!over && !is_cut_off(at)) {
    if (x.length && at.peer().now() >= end)
      break;
    at.peer().step(x.length ? std::min<duration>(end - at.peer().now(), 1s) : 1s);
  }
  if (!written)
    return exit_status::refused;
  if (interrupted)
    return exit_status::interrupted;
  if (is_cut_off(at))
    return fail_without_link(at);
  return x.count && printer.count() < *x.count && x.length
             ? fail("only " + report::counted(printer.count(), "change"))
             : exit_status::good;
}

} // namespace rubicon::cli
