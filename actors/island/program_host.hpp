// Programs that use the Mockup interface, inside the actor of their node or in one of their own.
#pragma once

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "actors/base/log.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/supervision.hpp"
#include "apps/application.hpp"
#include "config/plan/ecology.hpp"
#include "core/numbers/random.hpp"

namespace rubicon {

class program_host {
public:
  /// Makes programs and starts them on `node`, a mote::node, communication::pc or gateway::gateway.
  /// @param who their actor's path, without its kind
  /// @param again their node ran before: files go on
  template <class Node>
  void start(Node& node, const std::vector<apps::app_config>& configs, const std::string& who,
             std::uint64_t seed, bool again, instant now) {
    for (std::size_t i = 0; i < configs.size(); ++i)
      start_one(node, configs[i], i + 1, who, seed, again, now);
  }

  /// The same for one. @param node may be a communication::remote_process too
  /// @param number among the programs of the node
  template <class Node>
  void start_one(Node& node, const apps::app_config& config, std::size_t number,
                 const std::string& who, std::uint64_t seed, bool again, instant now) {
    const auto kind = std::string(apps::kind_of(config));
    start_made(node,
               apps::make_application(
                   config, random_stream(seed, who + '/' + kind + std::to_string(number))),
               kind, number, again, now);
  }

  /// The same for one that is made already.
  template <class Node>
  void start_made(Node& node, std::unique_ptr<apps::application> program, std::string kind,
                  std::size_t number, bool again, instant now) {
    auto& x = programs_.emplace_back();
    x.name = std::move(kind);
    x.number = static_cast<std::uint32_t>(number);
    x.program = std::move(program);
    x.started = now;
    x.open(again);
    x.program->start(node.attach(*x.program), now);
  }

  /// Starts one that has a name of its own, for events, logs and records.
  template <class Node>
  void start_as(Node& node, std::string path, std::unique_ptr<apps::application> program,
                instant now) {
    auto& x = programs_.emplace_back();
    x.path = std::move(path);
    x.program = std::move(program);
    x.program->start(node.attach(*x.program, x.path), now);
  }

  /// The program of that kind; nullptr: none was started.
  template <class Program>
  [[nodiscard]] Program* find() {
    for (auto& x : programs_)
      if (auto* found = dynamic_cast<Program*>(x.program.get()))
        return found;
    return nullptr;
  }

  /// Lets programs do what is due. @param theirs what their clock shows, at `now` of the node's
  /// @returns what comes of that at their node
  template <class Node>
  [[nodiscard]] auto on_time(Node& node, instant now, instant theirs) {
    node.begin(now);
    for (auto& x : programs_)
      x.program->on_time(theirs);
    if constexpr (requires { node.settle(now); })
      return node.settle(now);
    else
      return node.flush();
  }

  [[nodiscard]] std::optional<instant> deadline() const {
    std::optional<instant> due;
    for (const auto& x : programs_)
      due = earliest(due, x.program->deadline());
    return due;
  }

  template <class Node>
  [[nodiscard]] auto on_time(Node& node, instant now) {
    return on_time(node, now, now);
  }

  /// Sends the notices of programs, and writes what they have for their files.
  template <class Self>
  void send_notices(Self* self, const ecology_actor& ecology) {
    for (auto& x : programs_) {
      const auto& who = x.path.empty() ? self->path() : x.path;
      for (auto& what : x.program->take_notices())
        self->send(ecology, notable_event{who, std::move(what)});
      for (const auto& what : x.program->take_warnings())
        log_as(self, who, spdlog::level::warn, "{}", what);
      if (x.lines && x.lines->write(x.program->take_lines())) {
        const auto what = std::string(x.program->file()) + ": " + x.lines->failure;
        self->send(ecology, request_unmet{who, "cannot write " + what});
      }
    }
  }

  /// @param who the node's name in the report
  /// @param own by the node's clock
  /// @param ended the node's life is over: nothing is open any more
  template <class Self>
  void report(Self* self, const ecology_actor& ecology, const std::string& who, instant own,
              bool ended) const {
    for (const auto& x : programs_) {
      program_status status;
      status.program.who = who;
      status.program.kind = x.name;
      status.number = x.number;
      for (const auto& figure : x.program->figures()) {
        status.program.figures.emplace_back(figure.name, figure.value);
        if (!figure.counts)
          status.measured.push_back(figure.name);
      }
      status.streams = x.stream_ends(own, ended);
      const auto ahead = own - now(self); // the next life's clock begins with another time
      for (auto& end : status.streams) {
        end.changed_at -= ahead;
        for (auto* at : {&end.started_at, &end.first_at, &end.last_at}) {
          if (*at)
            **at -= ahead;
        }
      }
      if (x.lines)
        status.program.figures.emplace_back("lines not written",
                                            static_cast<double>(x.lines->unwritten));
      self->send(ecology, std::move(status));
    }
  }

  /// Vectors that programs have missed, by their number.
  [[nodiscard]] std::vector<std::pair<std::uint32_t, std::uint64_t>> vectors_missed() const {
    std::vector<std::pair<std::uint32_t, std::uint64_t>> found;
    for (const auto& x : programs_) {
      for (const auto& figure : x.program->figures()) {
        if (figure.name == "vectors missed")
          found.emplace_back(x.number, static_cast<std::uint64_t>(figure.value));
      }
    }
    return found;
  }

  /// Of a node without a clock of its island.
  [[nodiscard]] sample_status sample(std::uint64_t number, const std::string& who) const {
    sample_status x;
    x.sample = number;
    x.who = who;
    x.missed = vectors_missed();
    return x;
  }

private:
  /// The file of a program.
  struct line_file {
    std::ofstream file;
    std::string failure;         ///< the first; empty while all is well
    std::uint64_t unwritten = 0; ///< lines

    /// Lines are in the file when this returns. @returns whether the first failure has shown
    bool write(const std::string& lines) {
      if (!failure.empty() || (!lines.empty() && !(file << lines << std::flush)) || !file) {
        unwritten += static_cast<std::uint64_t>(std::count(lines.begin(), lines.end(), '\n'));
        const bool is_first = failure.empty();
        if (is_first)
          failure = std::generic_category().message(errno != 0 ? errno : EIO);
        return is_first;
      }
      return false;
    }
  };

  struct hosted {
    std::string path; ///< empty: its actor's
    std::string name;
    std::uint32_t number = 0; ///< among the programs of the node
    std::unique_ptr<apps::application> program;
    instant started;                  ///< by the node's clock
    std::unique_ptr<line_file> lines; ///< nullptr: it writes none

    void open(bool again) {
      const std::string name_of_file(program->file());
      if (name_of_file.empty())
        return;
      lines = std::make_unique<line_file>();
      lines->file.open(name_of_file, std::ios::binary | (again ? std::ios::app : std::ios::trunc));
      if (!again)
        lines->file << program->file_heading() << std::flush;
    }

    /// @param ended the node's life is over: what was open is not from now on
    [[nodiscard]] std::vector<apps::stream_end> stream_ends(instant own, bool ended) const {
      auto all = program->stream_ends(own);
      for (auto& end : all) {
        end.started_at = started;
        end.changed_at = end.open && ended ? own : std::max(end.changed_at, started);
        end.open = end.open && !ended;
      }
      return all;
    }
  };

  std::vector<hosted> programs_;
};

/// A program of a node, and its place among them all.
struct numbered_program {
  std::size_t number = 1;
  apps::app_config config;
  bool is_separate = false; ///< in an actor of its own
};

/// The programs among a node's apps.
template <class Apps>
[[nodiscard]] std::vector<numbered_program> programs_among(const Apps& all) {
  std::vector<numbered_program> found;
  for (const auto& app : all) {
    std::visit(
        [&found](const auto& x) {
          using kind = std::decay_t<decltype(x)>;
          if constexpr (std::is_same_v<kind, apps::app_config>)
            found.push_back({found.size() + 1, x, false});
          else if constexpr (std::is_same_v<kind, config::separate_app>)
            found.push_back({found.size() + 1, x.program, true});
        },
        app);
  }
  return found;
}

[[nodiscard]] inline std::vector<apps::app_config>
configs_of(const std::vector<numbered_program>& programs) {
  std::vector<apps::app_config> found;
  for (const auto& x : programs)
    found.push_back(x.config);
  return found;
}

} // namespace rubicon
