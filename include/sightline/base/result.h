#pragma once

// Result<T>: the value of a fallible operation or the reason why there is none.
// Member names follow std::expected, which it stands in for until every compiler has it.

#include <cassert>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace sightline {

// Says what is wrong, where, and what to do. One line.
struct Error {
  std::string message{};
};

template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Error error) : state_(std::move(error)) {}

  bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  // The accessors of the value require has_value(); error() requires the opposite. They move the value out of
  // a temporary, as in *findSomething().
  T& value() & {
    assert(has_value());
    return *std::get_if<0>(&state_);
  }
  const T& value() const& {
    assert(has_value());
    return *std::get_if<0>(&state_);
  }
  T&& value() && { return std::move(value()); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(value()); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  const Error& error() const {
    assert(!has_value());
    return *std::get_if<1>(&state_);
  }

 private:
  std::variant<T, Error> state_;
};

// The result of an operation that yields nothing but success.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}

  bool has_value() const { return !error_.has_value(); }
  explicit operator bool() const { return has_value(); }

  // Precondition: !has_value().
  const Error& error() const {
    assert(!has_value());
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

// X11/Xlib.h defines both names as macros. So public headers do without them, and a program that has included
// it has none of them.
#if !defined(Status) && !defined(Success)
using Status = Result<void>;
struct Success {
  operator Status() const { return {}; }
};
#endif

}  // namespace sightline
