// What the live page is told of an ecology before anything has happened (docs/view.md).
#pragma once

#include <string>

#include "config/ecology.hpp"

namespace rubicon::view {

/// What a page knows of the run that no description tells.
struct run_facts {
  std::string file = {};    ///< that describes the ecology
  std::string command = {}; ///< that repeats the run; empty: none does
  bool controls = false;    ///< the page may let faults happen, and set tuples
  bool messages = false;    ///< each message can be explained: the run is recorded
};

/// The message `ecology` of docs/view.md, without the facts of the run.
[[nodiscard]] std::string ecology_json(const config::ecology_description& x);

/// The same with the facts. @param ecology of ecology_json(); @param mode `virtual`, `wall` or
/// `record`; empty: as it is there
/// @returns nothing if that was none
[[nodiscard]] std::string with_facts(const std::string& ecology, const run_facts& facts,
                                     const std::string& mode);

} // namespace rubicon::view
