// The coordinator of an ecology on several hosts: starts their parts, polls their news, and merges
// their reports. Hosts go on without it.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cli/hosts/deployed.hpp"
#include "cli/print/console.hpp"
#include "config/plan/ecology.hpp"
#include "control/client.hpp"
#include "control/system.hpp"
#include "deploy/messages.hpp"
#include "io/loop.hpp"
#include "report/merge.hpp"

namespace rubicon::cli {

struct deployment_options {
  duration patience = 5s; ///< for hosts that do not answer at the start
  std::string log_level;
  bool attach = false;      ///< to what runs already
  bool prints_lines = true; ///< of the parts, on standard error
};

class deployment {
public:
  /// @param loop must outlive it
  /// @param id no other deployment has it; not used to attach
  deployment(io::loop& loop, control::system& actors, std::string id, deploy::packed file,
             const std::vector<deployed_host>& hosts, deployment_options options);
  ~deployment();
  deployment(const deployment&) = delete;
  deployment& operator=(const deployment&) = delete;

  /// Polls hosts, starts parts, prints news. @returns false once all is over
  [[nodiscard]] bool step();

  /// Ends all parts.
  void stop(bool interrupted);

  /// Requests a fault of the hosts that have what it names. Prints why a host refuses.
  void cause(const std::string& sentence);
  [[nodiscard]] duration elapsed() const;

  [[nodiscard]] bool has_begun() const { return began_.has_value(); }
  [[nodiscard]] const std::string& id() const { return id_; }

  /// It could not begin on some host; the reason was printed.
  [[nodiscard]] bool refused() const { return refused_; }

  [[nodiscard]] report::run_report whole_report() const;

private:
  using steady = std::chrono::steady_clock;

  enum class phase : std::uint8_t { greeting, facts, offer, ready, following, ended };

  struct followed {
    std::string name;
    std::unique_ptr<control::client> client;
    phase at = phase::greeting;
    steady::time_point asks_at;
    std::string trouble; ///< why it does not answer; empty: it does
    std::uint64_t line = 0;
    std::uint64_t change = 0;
    bool end_requested = false;
    std::deque<std::string> faults; ///< that it is to be asked for
    deploy::host_facts facts;
    report::host_report report;
    std::vector<std::uint64_t> lives; ///< numbers of those of `report`
  };

  [[nodiscard]] bool is_late() const;
  /// What the host is sent.
  [[nodiscard]] deploy::bundle part_for(const followed& x) const;
  void ask(followed& x);
  void ask(followed& x, deploy::question what,
           void (deployment::*then)(followed&, deploy::answer&));
  void on_silence(followed& x, const std::string& why);
  void on_greeting(followed& x, deploy::answer& found);
  void on_facts(followed& x, deploy::answer& found);
  [[nodiscard]] bool take_over(followed& x);
  void on_offer(followed& x, deploy::answer& found);
  void on_begun(followed& x, deploy::answer& found);
  void on_end_requested(followed& x, deploy::answer& found);
  void on_caused(followed& x, deploy::answer& found);
  void on_news(followed& x, deploy::answer& found);
  void take(followed& x, deploy::life_news& from);
  void fail(followed& x, const std::string& why);
  void say(const followed& x, const std::string& text);
  void draw_progress();
  void erase_progress();
  [[nodiscard]] std::string progress_of(const followed& x) const;

  std::string id_;
  deploy::bundle what_;
  std::vector<config::secret_place> secrets_; ///< of it
  config::ecology_description ecology_;
  deployment_options options_;
  const steady::time_point made_ = steady::now();
  std::optional<steady::time_point> began_;
  std::optional<steady::time_point> stopping_;
  bool interrupted_ = false;
  bool refused_ = false;
  const console errors_ = console_of(stderr);
  std::size_t lines_drawn_ = 0;
  steady::time_point drawn_at_;
  std::list<followed> hosts_;
};

} // namespace rubicon::cli
