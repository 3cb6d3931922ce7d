// How much a test runs: CI's share by default, the full counts nightly.
#pragma once

#include <cstdlib>

namespace hoodoo::testing
{

inline int count(int ci, int nightly)
{
    return std::getenv("HOODOO_NIGHTLY") ? nightly : ci;
}

}  // namespace hoodoo::testing
