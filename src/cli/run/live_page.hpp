// The live page of a run: `run --view` and `view RECORD`.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "actors/run/run.hpp"
#include "cli/run/message_reader.hpp"
#include "cli/words/watch_options.hpp"
#include "config/plan/ecology.hpp"
#include "deploy/bundle.hpp"
#include "io/tcp/web_server.hpp"
#include "view/conversation.hpp"
#include "view/ecology_json.hpp"
#include "view/timeline.hpp"

namespace rubicon::cli {

/// Actions that the page requests of a run: queued by the server's thread, performed by the run's.
class manual_control {
public:
  /// @param what the ecology that sentences are about
  /// @param owners of tuples that there can be
  /// @param kernels whether tuples may be set that steer a kernel (TUP-22)
  manual_control(deploy::bundle what, config::extensions known, std::set<std::string> owners = {},
                 bool kernels = false)
      : what_(std::move(what)), known_(std::move(known)), owners_(std::move(owners)),
        kernels_(kernels) {}

  /// For conversations. @pre this outlives them
  /// @param why_no_tuples the reply to requests to set one; empty: they are accepted
  [[nodiscard]] std::shared_ptr<const view::controls> controls(std::string why_no_tuples = {});

  /// Performs actions: a run, or all the hosts of one.
  struct performer {
    std::function<void(const std::string& sentence, const config::fault&)> cause;
    /// @returns false: there is no such peer
    std::function<bool(const std::string& owner, const std::string& key, const std::string& value)>
        set_tuple;
  };
  /// Performs what was requested since the last call. By the run's thread.
  /// @returns the actions, in words
  [[nodiscard]] std::vector<std::string> perform(const performer& by, instant now);

  /// The run is over: no request is accepted any more.
  void end();

  /// The actions as `[[fault]]` tables, for a file that repeats them; empty: there were none.
  [[nodiscard]] std::string repeated() const;

private:
  static constexpr std::size_t waiting_max = 64;
  static constexpr std::size_t taken_max = 10'000; ///< in all
  static constexpr std::size_t tuple_octets_max = 4096;

  struct action {
    std::string sentence = {}; ///< of a fault; empty: a tuple
    std::optional<config::fault> fault = {};
    std::string owner = {};
    std::string key = {};
    std::string value = {};
  };

  view::controls::outcome take(action x);
  [[nodiscard]] std::string refusal_of(const action& x) const;

  deploy::bundle what_;
  config::extensions known_;
  std::set<std::string> owners_;
  bool kernels_ = false;
  mutable std::mutex lock_;
  std::vector<action> waiting_;
  std::size_t taken_ = 0;
  bool over_ = false;
  std::vector<std::pair<instant, action>> done_;
};

class live_page {
public:
  /// Of a record that is written for the page alone.
  static constexpr std::uint64_t own_record_octets_max = 65 << 20;

  /// Serves the page from now on, and says where on standard error.
  /// @param ecology of view::ecology_json()
  /// @param picture file of the floor plan; empty: there is none
  /// @param record all that there is to be shown, from the beginning; nullptr: it arrives gradually
  /// @throws std::runtime_error if nobody can listen there
  live_page(const page_place& where, const std::string& ecology, const view::run_facts& facts,
            const std::string& mode, const std::string& picture,
            std::shared_ptr<const view::controls> controls,
            std::shared_ptr<const explain::traces> record = nullptr);

  /// Adds itself to the observers of the run. Outlives the run.
  void attach(run_options& options, const config::ecology_description& ecology);

  /// Adds a manual action to the timeline.
  void report_action(instant now, const std::string& what);

  /// The run is over.
  void finish(const report::run_report& x);

  /// From now on messages can be explained, as far as the run has recorded them there.
  /// @param is_own nobody else wants this record, and it ends at own_record_octets_max
  void read_on(const std::string& record, bool is_own);

  /// The reports of parts on other hosts so far, now and then.
  void show(const report::run_report& so_far, duration length);

  /// Until Ctrl-C or another signal to end.
  void stay();

private:
  std::string url_;
  std::shared_ptr<view::timeline> timeline_;
  std::vector<view::listed_event> plan_;
  std::size_t planned_ = 0; ///< of the plan, that have been added to the timeline
  using shown_event = std::tuple<instant, std::string, std::string>;
  std::set<shown_event> shown_;      ///< events of reports; of very many the newest,
  std::optional<instant> forgotten_; ///< and up to when the others were
  std::optional<message_reader> reader_;
  std::optional<io::web_server> server_; ///< its sessions ask the others
};

} // namespace rubicon::cli
