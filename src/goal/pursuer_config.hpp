// What a pursuer of goals is like.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/time.hpp"

namespace rubicon::goal {

/// Something a pursuer reads.
struct input_config {
  std::string name;
  std::string reference; ///< `(META <owner> <key>)`, where it points at first; empty: at the own
                         ///< tuple of its name (META-04)
};

/// A tuple that a pursuer publishes periodically.
struct output_config {
  std::string name;
  std::string value;           ///< at first
  duration every = 1s;         ///< more than 0
  double step = 0;             ///< added after each publication; @pre 0 unless `value` is a number
  std::optional<double> until; ///< no step leads beyond this
};

/// Holds for an input whose text is one of some, or whose number is in a range.
struct condition {
  std::string input;               ///< name of one of the inputs
  std::vector<std::string> equals; ///< if it is not empty, the others mean nothing
  std::optional<double> above;     ///< at or above this,
  std::optional<double> below;     ///< and below this
};

/// One step towards a goal.
struct state_config {
  std::string name;
  duration length{};              ///< more than 0
  duration jitter{};              ///< it lasts up to this much longer, uniform
  double failure_rate = 0;        ///< chance that it ends the goal as failed
  std::optional<condition> needs; ///< is waited for before the state is entered
  std::vector<std::pair<std::string, std::string>> sets; ///< outputs and their values afterwards
};

struct goal_config {
  std::string text;                 ///< which others write
  duration timeout = 1min;          ///< after so long the goal has failed
  std::vector<state_config> states; ///< one after the other, at least one
};

struct pursuer_config {
  std::string name; ///< first part of its keys
  std::vector<input_config> inputs;
  std::vector<output_config> outputs;
  std::vector<goal_config> goals;
};

} // namespace rubicon::goal
