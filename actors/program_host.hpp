// Programs that use the Mockup interface, inside the actor of their node.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "actors/messages.hpp"
#include "apps/application.hpp"
#include "core/random.hpp"

namespace rubicon {

class program_host {
public:
  /// Makes the programs among `configs` and starts them on `node`, a mote::node or endpoint::pc.
  /// @param who their actor's path, without its kind
  template <class Node>
  void start(Node& node, const std::vector<apps::app_config>& configs, const std::string& who,
             std::uint64_t seed, instant now) {
    for (const auto& config : configs) {
      auto& x = programs_.emplace_back();
      x.name = std::string(apps::kind_of(config));
      x.program = apps::make_application(
          config, random_stream(seed, who + '/' + x.name + std::to_string(programs_.size())));
      x.program->start(node.attach(*x.program), now);
    }
  }

  void on_time(instant now) {
    for (auto& x : programs_)
      x.program->on_time(now);
  }

  [[nodiscard]] std::optional<instant> deadline() const {
    std::optional<instant> due;
    for (const auto& x : programs_)
      due = earliest(due, x.program->deadline());
    return due;
  }

  /// Passes on what programs have to tell.
  template <class Self>
  void tell(Self* self, const ecology_actor& ecology) {
    for (auto& x : programs_) {
      for (auto& what : x.program->take_stories())
        self->send(ecology, story{self->path(), std::move(what)});
    }
  }

  /// @param who the node's name in the report
  template <class Self>
  void report(Self* self, const ecology_actor& ecology, const std::string& who) {
    for (const auto& x : programs_) {
      program_status status{{who, x.name, {}}};
      for (const auto& figure : x.program->figures())
        status.program.figures.emplace_back(figure.name, figure.value);
      self->send(ecology, std::move(status));
    }
  }

private:
  struct hosted {
    std::string name;
    std::unique_ptr<apps::application> program;
  };

  std::vector<hosted> programs_;
};

/// The programs among a node's apps.
template <class App>
[[nodiscard]] std::vector<apps::app_config> programs_among(const std::vector<App>& all) {
  std::vector<apps::app_config> found;
  for (const auto& app : all) {
    if (const auto* x = std::get_if<apps::app_config>(&app))
      found.push_back(*x);
  }
  return found;
}

} // namespace rubicon
