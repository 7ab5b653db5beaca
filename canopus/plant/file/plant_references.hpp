#pragma once
// Checks across the tables of a plant file: names must be unique, buses and slaves must exist, node-IDs and
// I/O points must not be used twice.

#include <vector>

#include "canopus/plant/file/plant_file.hpp"

namespace canopus::plant {

/// Finds them, names the bus of everything that leaves it out, and marks as not usable what cannot be built.
void check_references(PlantFile& plant, std::vector<text::FileError>& errors);

/// Adds the mistake of every server that would have the port of another one. In plant_file_servers.cpp.
void check_servers(const PlantFile& plant, std::vector<text::FileError>& errors);

}  // namespace canopus::plant
