// SPDX-License-Identifier: BSD-3-Clause
//
// Messages about the command line: checks of options' values, and what was probably meant.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace fcl_artic::app {

// Checks of an option's value: what is wrong with it, or nothing.
std::string requireNotNegative(const std::string& text);  ///< a number of at least 0
std::string requirePositive(const std::string& text);     ///< a number above 0
std::string requireInput(const std::string& path);        ///< something to read is there
std::string requirePng(const std::string& path);          ///< a file name that does not promise another format

/// The fault of the command line, in one line, and what was probably meant.
std::string usageError(const CLI::App& program, const CLI::ParseError& error);

}  // namespace fcl_artic::app
