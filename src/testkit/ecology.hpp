// Whole ecologies in tests: run them as far as a test wants, look at them, harm them (ACT-02).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "config/load.hpp"
#include "config/plan/ecology.hpp"
#include "core/time.hpp"
#include "report/report.hpp"
#include "testkit/failure.hpp"
#include "testkit/report.hpp"

namespace rubicon::test {

/// A text that describes no ecology, or no fault: what() is what `rubicon check` prints of it.
struct bad_description : std::runtime_error {
  using runtime_error::runtime_error;
};

struct ecology_options {
  std::optional<std::uint64_t> seed = std::nullopt; ///< instead of the text's
  config::extensions known = {}; ///< own applications and programs that the text names
};

/// What a text or a file describes. @throws bad_description
[[nodiscard]] config::ecology_description describe(std::string_view toml,
                                                   const ecology_options& options = {});
[[nodiscard]] config::ecology_description describe_file(const std::string& path,
                                                        const ecology_options& options = {});

/// Runs a description to its end, in the time that it asks for.
[[nodiscard]] report::run_report run(const config::ecology_description& what,
                                     std::uint64_t seed = 1);

/// An ecology in virtual time. Nothing happens but in the calls that let time go on. Of what its
/// actors log, only errors are shown.
class ecology {
public:
  /// @param toml as in a file; files that it names are looked for in the working directory
  /// @throws bad_description
  explicit ecology(std::string_view toml, ecology_options options = {});

  /// @throws bad_description
  [[nodiscard]] static ecology of_file(const std::string& path, ecology_options options = {});

  /// One that is built in code. @pre it holds what the loader of files makes sure of
  explicit ecology(config::ecology_description description, ecology_options options = {});

  ~ecology();
  ecology(ecology&&) noexcept;
  ecology& operator=(ecology&&) noexcept;

  // -- time; it may go on beyond the length that the description gives the run, but not beyond the
  // first flat battery if the description ends the run there

  [[nodiscard]] instant now() const;
  void run_for(duration length);
  void run_until(instant end);

  /// Runs in steps of `step` until `done` holds. @returns whether it does before `limit` has passed
  [[nodiscard]] bool run_until(const std::function<bool()>& done, duration limit,
                               duration step = 10ms);

  // -- faults

  /// Plans a fault, in the words of a file's `[[fault]]` (docs/configuration.md), without its
  /// heading: `inject("kind = 'kill'\npeer = 'robot'\nfor = '20s'")`. Without `at` and the like it
  /// happens now. What needs a radio that is not there yet must be in the description, or be given
  /// before time goes on: noise, a mote's double, a move to another island, a change of type.
  /// @throws bad_description, also if all of it would be in the past; std::logic_error if the
  ///         ecology was built in code
  void inject(std::string_view words);
  void inject(config::fault_description x);

  /// The same for a `[[change]]`: `change("kind = 'rate'\nmote = 'kitchen/stove'\nperiod = '5s'")`.
  void change(std::string_view words);

  // -- what is there now

  /// What the report would be if the run were over now: metrics, event log, violated invariants.
  /// What the file expects of the run is judged by finish() alone.
  [[nodiscard]] report::run_report report();

  /// What the invariants (docs/invariants.md) do not hold for, so far.
  [[nodiscard]] std::vector<report::violation> violations() { return report().violations; }

  /// @throws failure with the violations, if there are any
  void check_invariants();

  /// The text of a tuple as the peer of that name has it: one of its own, or its copy of another
  /// peer's. Nothing: it has none, or does not run. @throws failure if no peer is called so
  [[nodiscard]] std::optional<std::string> tuple(std::string_view peer, std::string_view key);
  [[nodiscard]] std::optional<std::string> tuple(std::string_view peer, std::string_view owner,
                                                 std::string_view key);

  /// What the simulated broker of the peer's MQTT bridge has retained, by topic.
  /// @throws failure if no peer is called so, or it has no bridge
  [[nodiscard]] const std::map<std::string, std::string>& retained(std::string_view peer);

  /// As has_logged(), of the event log so far.
  [[nodiscard]] bool logged(std::string_view who, std::string_view what);

  // -- the end

  /// Runs it to its length, if that has not passed yet, lets everybody leave, and returns the
  /// report, expectations included. Nothing else may be called afterwards.
  [[nodiscard]] report::run_report finish();

private:
  class parts;
  explicit ecology(std::unique_ptr<parts> x);

  std::unique_ptr<parts> parts_;
};

} // namespace rubicon::test
