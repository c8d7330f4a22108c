// What an option's number must be. CLI11's own validators answer with the largest double, 309 digits of it.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace poecal::app {

inline CLI::Validator numberWhere(bool (*holds)(double), const std::string& wanted, const std::string& name) {
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

}  // namespace poecal::app
