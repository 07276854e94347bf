#include "config/plan/quantities.hpp"

#include "config/file_readers.hpp"
#include "config/plan/uniqueness.hpp"

namespace rubicon::config {

quantities::quantities()
    : all_{{"temperature", "degrees Celsius", "C"},
           {"humidity", "percent", "%"},
           {"light", "lux", "lx"},
           {"voltage", "volts", "V"},
           {"presence", "0 or 1", ""},
           {"acceleration", "metres per second squared", "m/s2"},
           {"magnetism", "microtesla, or 0 and 1 of a reed contact", "uT"},
           {"sound", "decibels", "dB"},
           {"signal", "dBm", "dBm"}} {}

void quantities::add(std::string name, std::string unit) {
  all_.push_back({std::move(name), {}, std::move(unit)});
}

const std::string& quantities::word_of(device::quantity x) const {
  return all_.at(static_cast<std::size_t>(x)).name;
}

const std::string& quantities::unit_of(device::quantity x) const {
  return all_.at(static_cast<std::size_t>(x)).unit;
}

namespace {

/// [[quantity]]
struct own_quantity {
  std::string name;
  std::string unit;
};

auto quantity_keys() {
  return keys::of(
      keys::required(
          "name", &own_quantity::name, name_text{},
          "name, used like the predefined ones in `transducers` and wherever they are named"),
      keys::optional("unit", &own_quantity::unit, text{16},
                     {"unit of its values, of models and of bounds; fields that name the quantity "
                      "as their `transducer` publish it",
                      "none"}));
}

} // namespace

void read_quantities(table_reader& root) {
  auto& out = root.shared().quantities;
  name_uniqueness names;
  for (const auto& each : out.all())
    static_cast<void>(names.add(each.name, "quantity", {}, root.problems()));
  root.tables(
      "quantity", "[[quantity]]", "further quantities that motes measure", [&](table_reader& in) {
        own_quantity found;
        in.all(found, quantity_keys());
        auto& [name, unit] = found;
        if (!in.is_good("name") || !names.add(name, "quantity", in.at("name"), in.problems()))
          return;
        if (out.all().size() == device::quantities_max)
          in.problems().add(in.at(), "a file has at most " + std::to_string(quantities::own_max) +
                                         " quantities of its own");
        else
          out.add(std::move(name), std::move(unit));
      });
}

} // namespace rubicon::config
