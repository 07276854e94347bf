#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "config/file_readers.hpp"
#include "config/island/mote_readers.hpp"
#include "config/toml/values.hpp"
#include "firmware/program_config.hpp"

namespace rubicon::config {

namespace {

struct firmware_choice {
  std::string file;
  bool isolate = false;
  mark at; ///< of the file's name
};

constexpr about firmware_meaning{
    "[shared library](firmware.md) that runs on the mote instead of apps, relative to the folder "
    "of "
    "the TOML file; in an island with `stack = \"mac\"` or a base station",
    "none"};

constexpr text library_name{path_octets_max};

auto plain_keys() {
  return keys::of(
      keys::optional("firmware", &firmware_choice::file, library_name, firmware_meaning));
}

auto table_keys() {
  using x = firmware_choice;
  return keys::of(
      keys::required("file", &x::file, library_name,
                     {"shared library, relative to the folder of the TOML file", "", "file"}),
      keys::optional("isolate", &x::isolate, flag{},
                     "it runs in a process of its own with limits of time and memory: an error of "
                     "it ends its mote, and not the run"));
}

/// firmware = "blink.so", or firmware = { file = "blink.so" }
std::optional<firmware_choice> read_choice(table_reader& in) {
  firmware_choice out;
  const auto* given = in.content().find("firmware");
  if (given != nullptr && given->as<node_table>() == nullptr) {
    in.all(out, plain_keys());
    out.at = in.at("firmware");
    return in.is_good("firmware") ? std::optional(out) : std::nullopt;
  }
  bool is_good = false;
  in.table("firmware", "firmware", firmware_meaning, [&](table_reader& x) {
    x.all(out, table_keys());
    out.at = x.at("file");
    is_good = x.is_good("file");
  });
  in.instead_of_table("firmware", library_name);
  return is_good ? std::optional(out) : std::nullopt;
}

/// @returns nullptr if there is something wrong, which is then reported
std::shared_ptr<const firmware::library> read_library(table_reader& in, const std::string& file,
                                                      mark at) {
  const auto& files = *in.shared().files;
  const auto path = (std::filesystem::path(files.toml).parent_path() / file).string();
  const auto refuse = [&](const std::string& what) {
    in.problems().add(at, in_quotes(path) + ' ' + what);
    return nullptr;
  };
  const auto found = files.read(path, firmware::library_octets_max);
  if (!found.text)
    return refuse(found.reason);
  firmware::library out{std::filesystem::path(file).filename().string(), to_bytes(*found.text), {}};
  const auto judged = firmware::inspect(out.octets);
  if (const auto* wrong = std::get_if<std::string>(&judged))
    return refuse(*wrong);
  out.facts = std::get<firmware::library_facts>(judged);
  if (const auto wrong = firmware::refusal(out.facts); !wrong.empty())
    return refuse(wrong);
  return std::make_shared<const firmware::library>(std::move(out));
}

} // namespace

std::vector<placed_app> read_firmware(table_reader& in) {
  const auto choice = read_choice(in);
  if (!choice)
    return {};
  firmware::program_config app;
  app.isolate = choice->isolate;
  if (in.shared().files != nullptr)
    app.code = read_library(in, choice->file, choice->at);
  std::vector<placed_app> out;
  out.push_back({app, choice->at, {}, {}});
  return out;
}

} // namespace rubicon::config
