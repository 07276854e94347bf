#include "cli/run/run_watch.hpp"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "page/run_page.hpp"
#include "report/invariants.hpp"

namespace rubicon::cli {

namespace {

constexpr int samples = 100; ///< of a run, if nothing else is said
constexpr duration look_every_min = 1s;

std::ofstream made(const std::string& path) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (!file)
    throw std::runtime_error("cannot write " + path + ": " +
                             std::generic_category().message(errno != 0 ? errno : EIO));
  return file;
}

} // namespace

run_watch::run_watch(watch_options options, const config::ecology_description& ecology)
    : options_(std::move(options)), length_(ecology.length) {
  if (!options_.page_file.empty()) {
    page_ = made(options_.page_file);
    ecology_ = ecology;
  }
  if (options_.csv_folder.empty())
    return;
  tables_.emplace(ecology);
  std::error_code failure;
  std::filesystem::create_directories(options_.csv_folder, failure);
  if (failure)
    throw std::runtime_error(options_.csv_folder + ": " + failure.message());
  for (std::size_t i = 0; i < csv_.size(); ++i) {
    const auto which = static_cast<kind>(i);
    csv_[i] =
        made(options_.csv_folder + '/' + std::string(report::csv_tables::name(which)) + ".csv");
    csv_[i] << report::csv_tables::header(which);
  }
}

void run_watch::write(kind which, const std::string& rows) {
  csv_[static_cast<std::size_t>(which)] << rows;
}

void run_watch::attach(run_options& options) {
  const bool has_page = !options_.page_file.empty();
  const bool has_tables = !options_.csv_folder.empty();
  if (!has_page && !has_tables)
    return;
  const auto length = options.length.value_or(length_);
  options.look_every = options_.csv_every.value_or(std::max(length / samples, look_every_min));
  options.on_sample = [this, has_page, has_tables](const report::run_sample& x) {
    if (has_page)
      seen_.add(x);
    if (!has_tables)
      return;
    write(kind::energy, tables_->energy(x));
    write(kind::links, tables_->links(x));
    write(kind::losses, tables_->losses(x));
    write(kind::places, report::csv_tables::places(x));
  };
  options.on_tuple = [this, has_page, has_tables](const report::tuple_write& x) {
    if (has_page)
      seen_.add(x);
    if (has_tables)
      write(kind::tuples, report::csv_tables::row(x));
  };
  if (has_tables)
    options.on_event = [this](const report::logged_event& x) {
      write(kind::events, report::csv_tables::row(x));
    };
}

void run_watch::finish(report::run_report& x, const std::string& repeats,
                       const std::string& digest) {
  const auto complain = [&x](const std::string& path) {
    x.violations.push_back({instant{} + x.simulated, report::requests_are_met,
                            path + " is not complete: " + std::generic_category().message(EIO)});
  };
  for (std::size_t i = 0; i < csv_.size() && !options_.csv_folder.empty(); ++i)
    if (!csv_[i].flush())
      complain(options_.csv_folder + '/' +
               std::string(report::csv_tables::name(static_cast<kind>(i))) + ".csv");
  if (options_.page_file.empty())
    return;
  page_ << page::html_of({*ecology_, x, seen_, repeats, digest});
  if (!page_.flush())
    complain(options_.page_file);
}

} // namespace rubicon::cli
