#include "bridge/ros2/message_heading.hpp"

#include <cstddef>
#include <cstdint>

#include <nlohmann/json.hpp>

namespace rubicon::bridge {

namespace {

/// Ends the reading, by returning false, as soon as it knows all.
class heading_reader final : public nlohmann::json_sax<nlohmann::json> {
public:
  [[nodiscard]] bool is_complete() const { return !operation_.empty() && !topic_.empty(); }
  [[nodiscard]] std::string topic() const { return operation_ == "publish" ? topic_ : ""; }

  bool null() override { return true; }
  bool boolean(bool /*x*/) override { return true; }
  bool number_integer(std::int64_t /*x*/) override { return true; }
  bool number_unsigned(std::uint64_t /*x*/) override { return true; }
  bool number_float(double /*x*/, const std::string& /*text*/) override { return true; }
  bool binary(binary_t& /*x*/) override { return true; }
  bool start_object(std::size_t /*size*/) override { return go_in(); }
  bool end_object() override { return go_out(); }
  bool start_array(std::size_t /*size*/) override { return depth_ > 0 && go_in(); }
  bool end_array() override { return go_out(); }

  bool key(std::string& x) override {
    if (depth_ == 1)
      key_ = x;
    return true;
  }

  bool string(std::string& x) override {
    if (depth_ == 1 && key_ == "op")
      operation_ = x;
    else if (depth_ == 1 && key_ == "topic")
      topic_ = x;
    return !is_complete();
  }

  bool parse_error(std::size_t /*at*/, const std::string& /*token*/,
                   const nlohmann::json::exception& /*why*/) override {
    return false;
  }

private:
  bool go_in() {
    ++depth_;
    return true;
  }
  bool go_out() {
    --depth_;
    return true;
  }

  std::size_t depth_ = 0;
  std::string key_;
  std::string operation_;
  std::string topic_;
};

} // namespace

std::string topic_of_publication(std::string_view text) {
  heading_reader reader;
  static_cast<void>(nlohmann::json::sax_parse(text, &reader));
  return reader.is_complete() ? reader.topic() : std::string();
}

} // namespace rubicon::bridge
