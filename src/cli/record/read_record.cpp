#include "cli/record/read_record.hpp"

#include <cerrno>
#include <string_view>
#include <system_error>
#include <utility>

namespace rubicon::cli {

namespace {

constexpr const char* how_to_record = "; `rubicon run FILE --record RECORD` writes a record";

} // namespace

record_reader::record_reader(std::string path, bool keeps_view)
    : path_(std::move(path)), keeps_view_(keeps_view), file_(path_, std::ios::binary) {
  if (!file_)
    problem_ =
        path_ + ": cannot be read: " + std::generic_category().message(errno) + how_to_record;
}

bool record_reader::read_part() {
  if (!problem_.empty())
    return false;
  part_.resize(part_octets);
  file_.clear(); // it may have grown since its end was met
  file_.read(part_.data(), static_cast<std::streamsize>(part_.size()));
  part_.resize(static_cast<std::size_t>(file_.gcount()));
  octets_ += part_.size();
  take_lines();
  return !part_.empty();
}

void record_reader::take_lines() {
  std::string_view text = part_;
  for (auto end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    const auto problem = rest_.empty() ? lines_.take(text.substr(0, end))
                                       : lines_.take(rest_.append(text.substr(0, end)));
    rest_.clear();
    if (problem)
      return refuse(*problem);
    text.remove_prefix(end + 1);
    take_records();
  }
  rest_ += text;
}

void record_reader::take_records() {
  auto& taken = lines_.result();
  if (!all_)
    all_.emplace(taken.about, keeps_view_);
  for (const auto& each : taken.records)
    all_->take(each);
  taken.records.clear(); // it may be much longer than what was taken from it
}

void record_reader::finish() {
  if (!problem_.empty())
    return;
  if (const auto problem = lines_.finish(rest_))
    return refuse(*problem);
  cut_off_ = lines_.result().cut_off;
  take_records();
}

void record_reader::refuse(const explain::bad_line& x) {
  problem_ =
      path_ + ':' + std::to_string(x.line) + ": " + x.message + (x.line == 1 ? how_to_record : "");
}

std::variant<explain::traces, std::string> read_record(const std::string& path) {
  record_reader all(path);
  while (all.read_part()) {
  }
  all.finish();
  if (!all.problem().empty())
    return all.problem();
  return all.result();
}

} // namespace rubicon::cli
