// A cell's registration from a file: as it is, or as what is known of it beforehand.
#pragma once

#include <filesystem>

#include "poecal/cell/cell.hpp"

namespace poecal {

/// Reads the priors of a registration's transforms (format poecal-registration/1): those that the file holds, each with `fixed: true` or
/// with a `standard_deviation` of its own or in the file's, as `poecal measure` writes it.
/// @param registration  its setup says which transforms there are; its known_near and known_far are set.
/// @throws FileError: another setup, a transform without either word or with both, a deviation that is not positive, or no transform at
/// all.
void readKnownRegistration(const std::filesystem::path& file, Registration& registration);

/// The two poses of a registration.yaml, whatever it says of how well they are known. Which they are says the setup.
/// @throws FileError where one is missing.
Registration readRegistration(const std::filesystem::path& file);

}  // namespace poecal
