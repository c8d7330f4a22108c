// What an option's number must be. CLI11's own validators answer with the largest double, 309 digits of it.
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace poecal::app {

inline CLI::Validator numberWhere(std::function<bool(double)> holds, const std::string& wanted, const std::string& name) {
  return {[holds, wanted](std::string& word) {
            double number = 0.0;
            const bool is_number = CLI::detail::lexical_cast(word, number);
            return is_number && holds(number) ? std::string() : "'" + word + "': expected " + wanted;
          },
          name};
}

inline CLI::Validator positiveNumber() {
  return numberWhere([](double number) { return number > 0.0; }, "a number above 0", "POSITIVE");
}

inline CLI::Validator nonNegativeNumber() {
  return numberWhere([](double number) { return number >= 0.0; }, "0 or a number above it", "NONNEGATIVE");
}

/// A number from `low` to `high`, both among them.
inline CLI::Validator numberFrom(double low, double high, const std::string& unit) {
  return numberWhere([low, high](double number) { return number >= low && number <= high; },
                     fmt::format("{:g} to {:g} {}", low, high, unit), "NUMBER");
}

}  // namespace poecal::app
