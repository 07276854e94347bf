// One function for each alternative of a variant: std::visit compiles only while none is forgotten.
#pragma once

namespace rubicon {

/// std::visit(overloads{[&](const a& x) { ... }, [&](const b& x) { ... }}, variant);
template <class... Function>
struct overloads : Function... {
  using Function::operator()...;
};
template <class... Function>
overloads(Function...) -> overloads<Function...>;

} // namespace rubicon
