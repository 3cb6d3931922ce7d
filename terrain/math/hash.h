// Random numbers as pure functions of what they are for: seeds are hashed from names and cells, so adding a rock does not move a hill.
#pragma once

#include <cstdint>
#include <string_view>

namespace hoodoo
{

/// Bijective mixing of 64 bits (the finaliser of SplitMix64, Steele2014). Full avalanche.
constexpr std::uint64_t mix64(std::uint64_t x)
{
    x += 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

constexpr std::uint64_t hash_combine(std::uint64_t seed, std::uint64_t value)
{
    return mix64(seed ^ mix64(value));
}

/// Seed of the part called `name` under `seed` (FNV-1a over the bytes, then mixed). Never changes between versions.
constexpr std::uint64_t hash_name(std::uint64_t seed, std::string_view name)
{
    std::uint64_t h = 0xcbf29ce484222325ull;
    for (const char c : name) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
    return hash_combine(seed, h);
}

constexpr std::uint64_t hash_cell(std::uint64_t seed, std::int64_t i, std::int64_t j, std::int64_t k = 0)
{
    return hash_combine(hash_combine(hash_combine(seed, static_cast<std::uint64_t>(i)), static_cast<std::uint64_t>(j)),
                        static_cast<std::uint64_t>(k));
}

/// The high 53 bits of `h` as a number in [0, 1).
constexpr double unit_real(std::uint64_t h)
{
    return static_cast<double>(h >> 11) * 0x1p-53;
}

}  // namespace hoodoo
