// The description of an ecology that the live page receives first (docs/view.md).
#pragma once

#include <string>
#include <vector>

#include "config/plan/ecology.hpp"
#include "view/timeline.hpp"

namespace rubicon::view {

/// Facts of the run that are not part of an ecology's description.
struct run_facts {
  std::string file = {};    ///< that describes the ecology
  std::string command = {}; ///< that repeats the run; empty: none does
  bool controls = false;    ///< the page may let faults happen, and set tuples
  bool messages = false;    ///< each message can be explained: the run is recorded
};

/// What goes wrong by plan, ascending by time, as events; of very many the first.
[[nodiscard]] std::vector<listed_event> planned_faults(const config::ecology_description& x);

/// The same of a message `ecology`.
[[nodiscard]] std::vector<listed_event> planned_faults(const std::string& ecology);

/// The message `ecology` of docs/view.md, without the facts of the run.
[[nodiscard]] std::string ecology_json(const config::ecology_description& x);

/// The file of the floor plan in a message `ecology`, relative to the folder of the ecology's file;
/// empty: there is none.
[[nodiscard]] std::string plan_picture(const std::string& ecology);

/// The message with the facts. @param ecology of ecology_json(); @param mode `virtual`, `wall` or
/// `record`; empty: as it is there
/// @returns nothing if that was none
[[nodiscard]] std::string with_facts(const std::string& ecology, const run_facts& facts,
                                     const std::string& mode);

} // namespace rubicon::view
