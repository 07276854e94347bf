#include "control/server.hpp"

#include <algorithm>
#include <chrono>
#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "control/admission.hpp"
#include "control/frame.hpp"
#include "control/octets.hpp"
#include "control/refusal_log.hpp"
#include "io/process/machine.hpp"
#include "io/tcp/tcp_listener.hpp"
#include "io/timer.hpp"
#include "io/tls/secure_stream.hpp"

namespace rubicon::control {

namespace {

using steady = std::chrono::steady_clock;

/// Of the descriptors of the process, most are for what it runs.
constexpr std::size_t descriptors_per_unknown = 16;
constexpr std::size_t unknown_least = 4;

/// To refuse a connection costs some 40 us: of those that come by the thousand, so many wait.
constexpr std::uint64_t refusals_at_once = 8;
constexpr duration refusals_rest = 2ms;

admission_limits limits_here() {
  admission_limits out;
  const auto share = io::descriptors_max() / descriptors_per_unknown;
  out.all_max = std::clamp(share, unknown_least, out.all_max);
  out.of_address_max = std::min(out.of_address_max, out.all_max);
  return out;
}

std::string text_of(const ipv4_address& x) {
  std::string text;
  for (const auto octet : x)
    text += (text.empty() ? "" : ".") + std::to_string(octet);
  return text;
}

/// A person's program that speaks TLS, or nothing that we know, sees why it is closed.
payload plain_words() {
  return to_bytes(std::string_view("this is a rubicon host without certificates\n"));
}

} // namespace

struct server::state {
  using id = admission::id;

  ///   unknown --its certificate is believed (without TLS: a header)--> idle
  ///   idle --header--> asking --all of the question--> answering --answer has left--> idle
  enum class phase : std::uint8_t { unknown, idle, asking, answering };

  struct connection {
    connection(io::loop& where, std::string address) : from(std::move(address)), patience(where) {}

    std::string from;
    std::optional<io::secure_stream> stream;
    phase at = phase::unknown;
    frame_reader reader{question_limits()};
    io::timer patience;
    std::uint64_t identity = 0; ///< number of the one that it was believed by
    steady::time_point idle_since;
    steady::time_point asked_at;
  };

  state(system& in, io::loop& loop, handler f, reporter report_)
      : own(in.own()), where(loop), answer(std::move(f)), report(std::move(report_)),
        doors(limits_here()), log_timer(loop) {}

  io::tls_keeper& own;
  io::loop& where;
  handler answer;
  reporter report;
  admission doors;
  refusal_log log;
  io::timer log_timer;
  const steady::time_point begun = steady::now();
  id last_id = 0;
  std::map<id, connection> all;
  std::uint64_t too_often = 0; ///< connections so refused
  std::deque<id> with_files;   ///< they take turns, the first one is read
  std::optional<io::tcp_listener> listener;

  [[nodiscard]] instant now() const { return instant(steady::now() - begun); }

  void say(const std::string& line) const {
    if (report && !line.empty())
      report(line);
  }

  void refuse(const std::string& from, const std::string& why) {
    if (auto line = log.note(from, why, now()))
      say(*line);
    if (const auto due = log.deadline())
      log_timer.start(*due - now(), [this] {
        if (auto line = log.on_time(now()))
          say(*line);
      });
  }

  void on_connection(io::tcp_stream stream, const ipv4_address& address) {
    const auto who = ++last_id;
    const auto entry = doors.arrive(who, address, now());
    if (!entry.enters) {
      if (++too_often % refusals_at_once == 0)
        listener->rest(refusals_rest);
      return refuse(text_of(address), "connected too often");
    }
    if (entry.leaves) {
      refuse(all.at(*entry.leaves).from, "has too many unauthenticated connections");
      end(*entry.leaves);
    }
    look_for_certificate();
    auto& x = all.emplace(std::piecewise_construct, std::forward_as_tuple(who),
                          std::forward_as_tuple(where, text_of(address)))
                  .first->second;
    x.identity = own.changes();
    x.patience.start(unknown_max, [this, who] {
      close(who, "did not authenticate within " + to_text(unknown_max));
    });
    x.stream.emplace(
        std::move(stream), own.identity(), io::tls_session::side::server, "",
        io::secure_stream::callbacks{[this, who](const std::string&) { on_known(who); },
                                     [this, who](byte_view octets) { on_octets(who, octets); },
                                     [this, who] { on_answered(who); },
                                     [this, who](const std::string& why) { on_closed(who, why); }});
  }

  void look_for_certificate(bool again = false) {
    const auto before = own.changes();
    const auto list = number_of_list();
    say(own.look(again));
    if (number_of_list() != list)
      shut_out_revoked();
    if (own.changes() == before)
      return;
    std::vector<id> old; // whoever they were: they come again, and show what they have now
    for (const auto& [who, x] : all)
      if (x.at == phase::idle)
        old.push_back(who);
    for (const auto who : old)
      end(who);
  }

  [[nodiscard]] std::uint64_t number_of_list() const {
    return own.revoked() ? own.revoked()->number() : 0;
  }

  /// Whoever is on a list that has come goes.
  void shut_out_revoked() {
    std::map<id, std::string> gone;
    for (const auto& [who, x] : all)
      if (auto why = why_revoked(x); !why.empty())
        gone.emplace(who, std::move(why));
    for (const auto& [who, why] : gone)
      close(who, why);
  }

  /// Empty as long as it is not authenticated.
  [[nodiscard]] std::string why_revoked(const connection& x) const {
    return x.at == phase::unknown || !own.revoked() ? "" : x.stream->why_revoked(*own.revoked());
  }

  deploy::answer learn(const deploy::send_revoked& x) {
    const auto found = own.take(x.list);
    say(found.report.empty() || found.is_taken
            ? found.report
            : "rejected a list of revoked certificates: it " + found.report);
    return found.is_taken || found.report.empty() ? deploy::verdict{}
                                                  : deploy::verdict{{found.report}, true};
  }

  void on_known(id who) {
    auto& x = all.at(who);
    doors.leave(who);
    if (!make_room())
      return close(who, "connected while " + std::to_string(known_max) + " others were connected");
    x.at = phase::idle;
    if (const auto why = why_revoked(x); !why.empty()) // a list has come since it began
      return close(who, why);
    be_idle(who, x);
  }

  /// Who has asked nothing for longest, goes.
  bool make_room() {
    std::size_t known = 0;
    std::optional<id> longest;
    for (const auto& [who, x] : all) {
      known += x.at == phase::unknown ? 0 : 1;
      if (x.at == phase::idle && (!longest || x.idle_since < all.at(*longest).idle_since))
        longest = who;
    }
    if (known < known_max)
      return true;
    if (longest)
      end(*longest);
    return longest.has_value();
  }

  void be_idle(id who, connection& x) {
    x.idle_since = steady::now();
    x.patience.start(idle_max, [this, who] { end(who); });
  }

  void on_octets(id who, byte_view octets) {
    auto& x = all.at(who);
    if (x.at == phase::answering)
      return close(who, "sent a request before the answer to the previous one");
    while (!octets.empty() && x.reader.now() != frame_reader::state::complete &&
           x.reader.now() != frame_reader::state::refused)
      octets = octets.subspan(x.reader.feed(octets));
    if (x.reader.now() == frame_reader::state::refused) {
      if (!own.identity())
        x.stream->send(plain_words());
      return close(who, "sent an invalid request: " + x.reader.problem());
    }
    if (!octets.empty())
      return close(who, "sent a request before the answer to the previous one");
    if (x.reader.now() == frame_reader::state::header)
      return; // a part of it, which does not change it
    if (x.at == phase::unknown) {
      on_known(who);
      if (!all.contains(who))
        return;
    }
    if (x.at == phase::idle)
      begin_question(who, x);
    if (x.reader.now() == frame_reader::state::complete)
      on_question(who, x);
    else
      be_patient(who, x);
  }

  void begin_question(id who, connection& x) {
    x.at = phase::asking;
    x.asked_at = steady::now();
    if (x.reader.announced() <= small_octets_max)
      return;
    with_files.push_back(who);
    x.stream->read(with_files.front() == who);
  }

  /// What comes in pieces comes soon.
  void be_patient(id who, connection& x) {
    const bool has_files = x.reader.announced() > small_octets_max;
    const auto until = x.asked_at + (has_files ? files_max : silence_max);
    x.patience.start(std::min<duration>(silence_max, until - steady::now()), [this, who] {
      const auto& late = all.at(who);
      const bool waits = !with_files.empty() && late.reader.announced() > small_octets_max &&
                         with_files.front() != who && steady::now() < late.asked_at + files_max;
      if (waits)
        be_patient(who, all.at(who));
      else
        close(who, "did not complete its request");
    });
  }

  void on_question(id who, connection& x) {
    const auto asked = x.reader.take();
    x.stream->read(false);
    x.at = phase::answering;
    auto question = question_of(asked.kind, asked.content);
    if (!question)
      return close(who,
                   "sent a request of kind " + std::to_string(asked.kind) + " that is invalid");
    const auto* list = std::get_if<deploy::send_revoked>(&*question);
    const auto found = list != nullptr ? learn(*list) : answer(*std::move(question));
    next_with_files(who);
    if (list != nullptr)
      shut_out_revoked();
    if (all.contains(who))
      reply(who, asked, found);
  }

  void reply(id who, const frame& to, const deploy::answer& found) {
    auto& x = all.at(who);
    frame out{answer_kind(to.kind), to.number, octets_of(found)};
    if (out.kind != found.index() || out.content.size() > answer_limits()[out.kind])
      return close(who, "requested more than fits into an answer");
    x.patience.start(unread_max, [this, who] { close(who, "did not read its answer"); });
    x.stream->send(encode_header(out));
    x.stream->send(std::move(out.content));
  }

  void on_answered(id who) {
    auto& x = all.at(who);
    if (x.at != phase::answering)
      return; // words to whom is closed
    if (x.identity != own.changes())
      return end(who);
    x.at = phase::idle;
    x.stream->read(true);
    be_idle(who, x);
  }

  void on_closed(id who, const std::string& why) {
    const auto& x = all.at(who);
    if (x.at == phase::unknown)
      refuse(x.from, why);
    end(who);
  }

  void close(id who, const std::string& why) {
    refuse(all.at(who).from, why);
    end(who);
  }

  void end(id who) {
    doors.leave(who);
    next_with_files(who);
    all.erase(who);
  }

  void next_with_files(id who) {
    const bool was_first = !with_files.empty() && with_files.front() == who;
    std::erase(with_files, who);
    if (was_first && !with_files.empty())
      all.at(with_files.front()).stream->read(true);
  }
};

std::variant<server, std::string> server::open(system& in, io::loop& where,
                                               const std::string& address, std::uint16_t port,
                                               handler f, reporter report) {
  auto made = std::make_unique<state>(in, where, std::move(f), std::move(report));
  auto opened = io::tcp_listener::open(
      where, address, port, [x = made.get()](io::tcp_stream stream, const ipv4_address& from) {
        x->on_connection(std::move(stream), from);
      });
  if (const auto* why = std::get_if<std::string>(&opened))
    return *why;
  made->listener.emplace(std::get<io::tcp_listener>(std::move(opened)));
  if (port != 0 && made->listener->port() != port)
    return "cannot listen on " + address + ':' + std::to_string(port) +
           ": the port is taken: choose another";
  return server(std::move(made));
}

server::server(std::unique_ptr<state> x) : state_(std::move(x)) {}
server::~server() = default;
server::server(server&&) noexcept = default;
server& server::operator=(server&&) noexcept = default;

std::uint16_t server::port() const {
  return state_->listener->port();
}

void server::renew() {
  state_->look_for_certificate(/*again=*/true);
}

} // namespace rubicon::control
