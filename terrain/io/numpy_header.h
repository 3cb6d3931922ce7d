// The head of a NumPy array as it stands in a file: type, shape, where the numbers begin.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace hoodoo
{

/// One array of plain numbers in C order.
struct NumpyHeader {
    std::vector<std::size_t> shape;
    std::uint64_t count = 1;  ///< of numbers
    std::size_t width = 0;    ///< bytes a number
    std::size_t data = 0;     ///< where the numbers begin, bytes
    bool swapped = false;     ///< high byte first
    double (*read)(const unsigned char*, bool swapped) = nullptr;

    /// As many numbers as there is room for, from bytes that hold them.
    void convert(const unsigned char* from, std::span<double> to) const;
};

/// No header is longer than this, as we read them.
constexpr std::size_t kMostNumpyHeader = 4096;

/// Reads the head from the first bytes of an array (all of it, or at least kMostNumpyHeader). `name` is what errors call the array. Throws Error
/// (file): no array, a type that is no plain number, Fortran order, over 2^27 numbers unless `most` says otherwise.
NumpyHeader read_numpy_header(const std::string& path, const std::string& name, const unsigned char* bytes, std::size_t size,
                              std::uint64_t most = 1ull << 27);

}  // namespace hoodoo
