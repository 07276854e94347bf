// What the messages of an exported record consist of, as JSON Schema.
#pragma once

#include <string_view>

#include "exports/mcap_writer.hpp"

namespace rubicon::exports {

/// A topic and what is sent there.
struct topic {
  std::string_view name;
  mcap_schema schema;
};

extern const topic messages_topic;
extern const topic tuples_topic;
extern const topic events_topic;
extern const topic places_topic;
extern const topic links_topic;
extern const topic scene_topic;

} // namespace rubicon::exports
