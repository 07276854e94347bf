// What a file says of others by their names, and where. Whether it can work is known when all of
// the file is read: warnings.hpp.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/toml/problem.hpp"
#include "core/address.hpp"
#include "device/trace_file.hpp"

namespace rubicon::config {

/// A tuple that is read, watched, written or pointed at.
struct tuple_use {
  std::string who; ///< `a rule of pc writes`
  std::string key; ///< parts may be `*`
  mark at;
};

/// A value that a tuple is compared with.
struct tuple_test {
  std::string who; ///< `a rule of pc`
  std::string key;
  std::vector<located<std::string>> equals; ///< one of these,
  std::optional<located<double>> above{};   ///< or a number at or above this,
  std::optional<located<double>> below{};   ///< and below this
};

/// Words that a tuple is given.
struct tuple_write {
  std::string who; ///< `a rule of pc`
  std::string key;
  mark at;
  std::vector<located<std::string>> words;
};

/// A class of proxies, with its parts by name.
struct class_places {
  mark at;
  mark prefix;
  std::map<std::string, mark, std::less<>> fields;
  std::map<std::string, mark, std::less<>> inputs;
};

struct mote_places {
  mark at;   ///< its position, or its table
  mark walk; ///< its `step`, or its `path`
};

struct trace_place {
  mark at;
  std::string file; ///< as the file calls it
  device::trace_time start;
};

/// A secret that the file has written: secrets.hpp.
struct secret_place {
  std::string name; ///< `smepp.group.NAME.master_key`
  mark at;          ///< of its value
};

struct file_places {
  std::string peer; ///< whose apps are read
  std::vector<tuple_use> uses;
  std::vector<tuple_test> tests;
  std::vector<tuple_write> writes;
  std::map<std::string, class_places, std::less<>> classes;
  std::map<mote_address, mote_places> motes;
  std::map<std::shared_ptr<const device::trace_table>, trace_place> traces;
  std::vector<secret_place> secrets; ///< in the order in which they are read
};

} // namespace rubicon::config
