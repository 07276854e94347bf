#include "proxy/classes/proxy_class.hpp"

#include "proxy/classes/program.hpp"

namespace rubicon::proxy {

proxy_class::proxy_class() = default;
proxy_class::~proxy_class() = default;
proxy_class::proxy_class(const proxy_class&) = default;
proxy_class& proxy_class::operator=(const proxy_class&) = default;
proxy_class::proxy_class(proxy_class&&) noexcept = default;
proxy_class& proxy_class::operator=(proxy_class&&) noexcept = default;

} // namespace rubicon::proxy
