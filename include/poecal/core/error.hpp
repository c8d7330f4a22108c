// Errors that a person can act on: each carries the exit status of the program that meets it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "poecal/core/printable.hpp"

namespace poecal {

/// Base of everything that poecal throws on purpose. what() is one sentence, without a trailing newline, as printableLine() makes it: of a
/// message that quotes a file of a stranger nothing moves a cursor, and no more than kLongestPrintedLine bytes are left.
class Error : public std::runtime_error {
 public:
  Error(const std::string& message, int exit_status) : std::runtime_error(printableLine(message)), exit_status_(exit_status) {}
  /// Exit status of the program: 2 wrong call, 3 bad input, 4 the data cannot support what was asked.
  int exitStatus() const { return exit_status_; }

 private:
  int exit_status_;
};

/// A caller's mistake: a value outside its domain, an option that does not exist. Exit status 2.
class InvalidArgument : public Error {
 public:
  explicit InvalidArgument(const std::string& message) : Error(message, 2) {}
};

/// Bad input: what() is `FILE:LINE: what is wrong, what was expected` (`FILE: ...` where there is no line). Exit status 3.
class FileError : public Error {
 public:
  /// @param line  1-based; 0 where the file as a whole is meant.
  FileError(const std::filesystem::path& file, int line, const std::string& message) : FileError(placeOf(file, line), message) {}
  /// What is wrong and what was expected, without the place.
  std::string reason() const { return std::string(what()).substr(reason_begin_); }

 private:
  FileError(const std::string& place, const std::string& message)
      : Error(place + printableLine(message, kLongestPrintedLine - place.size()), 3), reason_begin_(place.size()) {}
  /// `FILE:LINE: `. However long the path is, there is room behind it for what is wrong.
  static std::string placeOf(const std::filesystem::path& file, int line) {
    return printableLine(file.string(), kLongestPrintedLine / 3) + (line > 0 ? ":" + std::to_string(line) : "") + ": ";
  }

  std::size_t reason_begin_;
};

/// Input that is well-formed but cannot be true: joints in degrees, mirrored corners. what() names the suspected mistake; code that knows
/// the file makes it a FileError. Exit status 3.
class ImplausibleInput : public Error {
 public:
  explicit ImplausibleInput(const std::string& message) : Error(message, 3) {}
};

/// The machine has too little memory for what was asked: nothing is wrong with the input, and nothing is known of it either. Exit status 3.
class OutOfMemory : public Error {
 public:
  /// @param what_for  "to search images/0001.png"
  explicit OutOfMemory(const std::string& what_for)
      : Error("memory: there is not enough " + what_for + ", expected more of it (--jobs 1 needs least)", 3) {}
};

/// The data cannot support what was asked: too few poses, no motion about some axis. Exit status 4.
class InsufficientData : public Error {
 public:
  explicit InsufficientData(const std::string& message) : Error(message, 4) {}
};

}  // namespace poecal
