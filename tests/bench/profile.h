// Where a piece of work spends its time: the program counter, sampled every millisecond of processor time.
#pragma once

#include <functional>
#include <map>
#include <string>

namespace hoodoo::bench
{

/// Runs `work` and returns the share of samples in each class that `classify` makes of a demangled function name (or a library's file name, where the
/// library has no symbols). Not reentrant.
std::map<std::string, double> profile(const std::function<void()>& work, const std::function<std::string(const std::string&)>& classify);

}  // namespace hoodoo::bench
