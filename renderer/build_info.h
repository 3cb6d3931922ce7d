// What this program is made of and runs on: for `hoodoo version` and for the header of every picture.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace hoodoo
{

std::string version();                                                ///< "0.1.0"
std::vector<std::pair<std::string, std::string>> library_versions();  ///< name, version: those the program was built with
std::string processor_name();                                         ///< as the processor calls itself; "unknown" where it does not
std::string baseline_name();                                          ///< oldest processor this build runs on, "x86-64-v3"

}  // namespace hoodoo
