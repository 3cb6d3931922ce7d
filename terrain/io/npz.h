// NumPy's archives: named arrays of numbers in a zip file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hoodoo
{

/// Any of NumPy's integers and reals, as double; the last index runs fastest. A scalar has no shape and one value.
struct NumpyArray {
    std::vector<std::size_t> shape;
    std::vector<double> values;
};

/// The archive's table of contents; arrays are read on demand. Throws Error (file): no zip, damaged, an unknown type, over 2^27 numbers.
class NpzFile
{
public:
    explicit NpzFile(const std::string& path);

    const std::vector<std::string>& names() const { return names_; }
    bool has(const std::string& name) const;
    NumpyArray read(const std::string& name) const;

private:
    struct Entry {
        std::uint64_t offset, packed, size;
        int method;
    };
    std::string path_;
    std::vector<unsigned char> bytes_;
    std::vector<std::string> names_;
    std::vector<Entry> entries_;
};

}  // namespace hoodoo
