// Tuples that a proxy class describes as templates, in text or as JSON (PXY-04).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/time.hpp"
#include "proxy/classes/layout.hpp"
#include "proxy/classes/proxy_class.hpp"

namespace rubicon::proxy {

/// A piece of a template: plain text, or the name that stood in braces.
struct template_part {
  std::string text;
  bool is_name = false;

  friend bool operator==(const template_part&, const template_part&) = default;
};

/// `{{` and `}}` are braces in the text.
/// @returns errc::bad_value for a brace without its partner, and for `{}`
[[nodiscard]] result<std::vector<template_part>> template_parts(std::string_view text);

/// Names and what they stand for.
using name_values = std::vector<std::pair<std::string, std::string>>;

/// Names that templates of all classes know, beside properties; of motes, and of tagged objects.
[[nodiscard]] const std::vector<std::string>& mote_template_names();
[[nodiscard]] const std::vector<std::string>& object_template_names();

/// The field that a name of a template's text is about: `temperature`, `temperature.unit`. nullptr
/// if it is about none.
[[nodiscard]] const field* field_named(const proxy_class& what, std::string_view name);

/// What the template's fields are read from; nothing if it has none. @pre all its fields are read
/// together
[[nodiscard]] std::optional<reading_source> source_of(const proxy_class& what,
                                                      const tuple_template& x);

/// The tuples of one proxy.
class tuple_templates {
public:
  struct tuple {
    std::string key; ///< perhaps longer than keys may be
    std::string text;
  };

  tuple_templates() = default;
  /// @param names prior ones: {island}, {id}, {name}, properties; {class} and {room} are added. The
  /// room is the property of that name, else the island's name
  tuple_templates(const proxy_class& what, name_values names);

  /// Those without fields.
  [[nodiscard]] std::vector<tuple> at_start() const;

  /// Those whose fields are read from there. A JSON object has their values by name, in the order
  /// of the template, after the time of the message in seconds:
  /// `{"time":12.0,"temperature":{"value":22.3,"unit":"C"},"door":{"value":"open"}}`
  [[nodiscard]] std::vector<tuple> on_readings(reading_source from, const std::vector<reading>& all,
                                               instant now) const;

private:
  struct prepared {
    std::string key;
    std::vector<template_part> parts; ///< prior names are filled in; empty for JSON
    std::vector<std::string> json;
    std::optional<reading_source> source;
  };

  std::vector<prepared> all_;
  std::vector<std::string> words_; ///< fields that may be words: texts in JSON
};

} // namespace rubicon::proxy
