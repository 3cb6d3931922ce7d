// Owen-scrambled Sobol' points, padded in sets of four dimensions and evaluated by hashing (Burley2020): numbers without state.
//
// The generator matrices come from Boost's table (direction numbers of Joe2008, 3667 dimensions), expanded once to 32 bits by the recurrence
//     m_k = 2 a_1 m_(k-1) ^ 4 a_2 m_(k-2) ^ ... ^ 2^d m_(k-d) ^ m_(k-d).
// A set uses the first four dimensions, whose projections are the best, at the sample's index *shuffled* by a scrambling of its own: sets are then
// independent of each other, yet each is a net over every aligned block of 2^k samples. The scrambling is the hash of Laine2011 with the multipliers
// of Burley2020's follow-up by Vegdahl2021, on reversed bits, so that a bit depends on the higher ones only.
// Deviation: bytes of the index look their part of a point up in tables of 256 entries, which gives the same bits as 32 conditional xors.

#include "renderer/transport/sampler.h"

#include <boost/random/detail/sobol_table.hpp>

#include <vector>

namespace hoodoo
{
namespace
{

constexpr unsigned kBits = 32;
using Matrix = std::array<std::uint32_t, kBits>;  // column k: what bit k of the index contributes

constexpr std::uint32_t reverse_bits(std::uint32_t x)
{
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

Matrix make_matrix(unsigned dimension)
{
    using Table = boost::random::detail::qrng_tables::sobol;
    Matrix m{};
    if (dimension == 0) {  // the van der Corput sequence
        for (unsigned k = 0; k < kBits; ++k) m[k] = 1u << (kBits - 1 - k);
        return m;
    }
    const unsigned polynomial = Table::polynomial(dimension - 1);
    const unsigned degree = kBits - 1 - static_cast<unsigned>(__builtin_clz(polynomial));
    for (unsigned k = 0; k < kBits; ++k) {
        if (k < degree) {
            m[k] = Table::minit(dimension - 1, k);
            continue;
        }
        m[k] = m[k - degree] ^ (m[k - degree] << degree);
        for (unsigned j = 1; j < degree; ++j)
            if ((polynomial >> (degree - j)) & 1u) m[k] ^= m[k - j] << j;
    }
    for (unsigned k = 0; k < kBits; ++k) m[k] <<= kBits - 1 - k;
    return m;
}

std::uint32_t multiply(const Matrix& m, std::uint32_t index)
{
    std::uint32_t x = 0;
    for (unsigned k = 0; index != 0; ++k, index >>= 1)
        if (index & 1u) x ^= m[k];
    return x;
}

/// What each byte of an index contributes to dimensions 1 to 3 of a set (dimension 0 is the reversed index itself).
struct ByteTables {
    std::array<std::array<std::array<std::uint32_t, Sampler::set_size - 1>, 256>, 4> bytes;

    ByteTables()
    {
        for (unsigned d = 1; d < Sampler::set_size; ++d) {
            const Matrix m = make_matrix(d);
            for (unsigned b = 0; b < 4; ++b)
                for (std::uint32_t v = 0; v < 256; ++v) bytes[b][v][d - 1] = multiply(m, v << (8 * b));
        }
    }
};
const ByteTables tables;

/// The scrambling on reversed bits: each step lets a bit depend on lower ones only.
constexpr std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed)
{
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

constexpr std::uint32_t scrambled(std::uint32_t fraction, std::uint32_t seed)
{
    return reverse_bits(scramble_reversed(reverse_bits(fraction), seed));
}

}  // namespace

std::uint32_t sobol_bits(std::uint32_t index, unsigned dimension)
{
    return multiply(make_matrix(dimension), index);
}

std::uint32_t owen_scramble(std::uint32_t fraction, std::uint32_t seed)
{
    return scrambled(fraction, seed);
}

std::array<double, Sampler::set_size> Sampler::get(std::uint32_t set) const
{
    const std::uint64_t a = mix64(key_ + set), b = mix64(a), c = mix64(b);

    // Shuffle: each bit of the index depends on the higher ones, so aligned blocks of 2^k samples stay together and sets pair up at random. (Were it
    // the lower ones, the leading bits of all sets would agree within a pixel.)
    const std::uint32_t index = scrambled(sample_, static_cast<std::uint32_t>(a));

    std::array<std::uint32_t, set_size> x{reverse_bits(index), 0, 0, 0};
    for (unsigned byte = 0; byte < 4; ++byte) {
        const auto& part = tables.bytes[byte][(index >> (8 * byte)) & 255u];
        for (unsigned d = 1; d < set_size; ++d) x[d] ^= part[d - 1];
    }
    const std::array<std::uint32_t, set_size> seeds{static_cast<std::uint32_t>(a >> 32), static_cast<std::uint32_t>(b),
                                                    static_cast<std::uint32_t>(b >> 32), static_cast<std::uint32_t>(c)};
    std::array<double, set_size> u;
    for (unsigned d = 0; d < set_size; ++d) u[d] = scrambled(x[d], seeds[d]) * 0x1p-32;
    return u;
}

}  // namespace hoodoo
