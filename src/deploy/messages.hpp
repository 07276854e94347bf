// What a coordinator asks a host, and what the host answers. Nothing is sent unasked: who is slow
// is asked less often, and nothing piles up anywhere.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "deploy/bundle.hpp"
#include "report/merge.hpp"

namespace rubicon::deploy {

/// The answer to a request: yes, or why not.
struct verdict {
  std::vector<std::string> problems; ///< empty: it is so, or is done
  bool concerned = true;             ///< of a fault: something of it is here
};
RUBICON_FIELDS(verdict, problems, concerned);

/// The first question, and its answer; the same in all versions, so that they can detect that
/// they differ.
struct greeting {
  std::string version;
  using answer = greeting;
};
RUBICON_FIELDS(greeting, version);

enum class part_state : std::uint8_t {
  none,    ///< the host has nothing to run
  offered, ///< it could begin
  running,
  waiting, ///< its process was killed and begins again
  ended,   ///< it has reported everything
};

/// Described for people.
[[nodiscard]] const char* to_string(part_state x);

struct host_facts {
  std::string host; ///< name
  part_state state = part_state::none;
  std::string deployment; ///< id of what it has; empty: nothing. The others are empty then
  std::string ecology;    ///< its name
  std::string files_hash; ///< of its bundle
  std::uint64_t seed = 0;
  duration length{};
  duration elapsed{};            ///< since it began on all hosts
  bool refused = false;          ///< its process would not begin, and has said why
  std::uint32_t lives = 0;       ///< processes of the part so far
  std::uint64_t memory = 0;      ///< octets of its process
  std::int64_t clock_us = 0;     ///< of the system, since 1970, UTC
  std::uint64_t revocations = 0; ///< number of its list of revoked certificates; 0: it has none
  bool may_deploy = false;       ///< its certificate is a coordinator's, too
};
RUBICON_FIELDS(host_facts, host, state, deployment, ecology, files_hash, seed, length, elapsed,
               refused, lives, memory, clock_us, revocations, may_deploy);

struct ask_facts {
  using answer = host_facts;
};
RUBICON_FIELDS(ask_facts);

/// Can you run this part? The files stay there until the next offer.
struct offer {
  std::string deployment; ///< its id
  std::string host;
  bundle what;
  std::string log_level;
  bool only_asks = false; ///< nothing is stored
  using answer = verdict;
};
RUBICON_FIELDS(offer, deployment, host, what, log_level, only_asks);

/// The part that was offered begins, if it has not.
struct begin_part {
  std::string deployment;
  duration elapsed{}; ///< for which others have run
  using answer = verdict;
};
RUBICON_FIELDS(begin_part, deployment, elapsed);

/// The part ends early, and reports everything.
struct end_part {
  std::string deployment;
  using answer = verdict;
};
RUBICON_FIELDS(end_part, deployment);

/// A fault happens now: `kill peer robot for 10s`.
struct cause_fault {
  std::string deployment;
  std::string sentence;
  using answer = verdict;
};
RUBICON_FIELDS(cause_fault, deployment, sentence);

/// What a process of the part has reported so far.
struct life_news {
  std::uint64_t life = 0; ///< no other has this number, on this host
  duration elapsed{};     ///< of the whole when it began
  duration ended{};       ///< of the whole when it ended; 0: it runs, or its end is not known
  bool is_final = false;
  report::part_report newest; ///< without a name: nothing
};
RUBICON_FIELDS(life_news, life, elapsed, ended, is_final, newest);

struct news {
  std::uint64_t line = 0;   ///< number of the last one of `lines`, and of the last change of
  std::uint64_t change = 0; ///< `lives`: what the next question is to say
  std::uint64_t lines_left_out = 0;
  std::vector<std::string> lines; ///< that the part has written
  std::vector<life_news> lives;   ///< those with a newer report, the oldest first
  host_facts facts;
  bool has_more = false; ///< of `lives`: the next question brings them
};
RUBICON_FIELDS(news, line, change, lines_left_out, lines, lives, facts, has_more);

struct ask_news {
  std::string deployment;
  std::uint64_t line = 0;   ///< what comes behind it is new, 0: all
  std::uint64_t change = 0; ///< likewise
  using answer = news;
};
RUBICON_FIELDS(ask_news, deployment, line, change);

/// Runs of an experiment, each with a seed of its own.
struct seed_result {
  std::uint64_t seed = 0;
  std::int32_t status = 0; ///< exit status; -1 if a signal ended it
  std::int32_t signal = 0;
  bool overran = false;
  bool overlong = false;
  duration real{};
  std::string out; ///< its report
  std::string err;
};
RUBICON_FIELDS(seed_result, seed, status, signal, overran, overlong, real, out, err);

/// The files of an experiment, before its seeds.
struct offer_seeds {
  std::string experiment; ///< its id
  bundle what;
  duration timeout{}; ///< of real time, for each run
  using answer = verdict;
};
RUBICON_FIELDS(offer_seeds, experiment, what, timeout);

struct seeds_news {
  std::vector<std::string> problems; ///< not empty: it runs none, and this is why
  std::uint64_t upto = 0;
  std::vector<seed_result> results; ///< not acknowledged yet
  std::uint32_t jobs = 0;           ///< runs at a time
};
RUBICON_FIELDS(seeds_news, problems, upto, results, jobs);

/// More seeds, and what is new of earlier ones.
struct run_seeds {
  std::string experiment;
  std::vector<std::uint64_t> seeds; ///< none twice; none at all: only asks
  std::uint64_t after = 0;          ///< results up to this one have arrived
  bool ends = false;                ///< what runs is ended, and the files are forgotten
  using answer = seeds_news;
};
RUBICON_FIELDS(run_seeds, experiment, seeds, after, ends);

/// The authority's list of certificates that are revoked. A client that has one sends it on each
/// new connection.
struct send_revoked {
  std::string list; ///< in PEM
  using answer = verdict;
};
RUBICON_FIELDS(send_revoked, list);

using question = std::variant<greeting, ask_facts, offer, begin_part, end_part, cause_fault,
                              ask_news, offer_seeds, run_seeds, send_revoked>;
/// Who takes longer does not answer; files take longer to transfer.
[[nodiscard]] inline duration patience_for(const question& x) {
  const bool has_files = std::holds_alternative<offer>(x) || std::holds_alternative<offer_seeds>(x);
  return has_files ? duration(1min) : duration(5s);
}

using answer = std::variant<greeting, host_facts, verdict, news, seeds_news>;

} // namespace rubicon::deploy
